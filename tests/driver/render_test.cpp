// `gradus render`: what it writes, and what it does where it cannot.
#include "driver/memory_check.h"
#include "runtime/error.h"
#include "runtime/io/image_io.h"
#include "tests/driver/child_process.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <memory>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gradus {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class Render : public ProgramTest {
  protected:
    Outcome render(std::vector<std::string> options, std::size_t file_size_limit = 0) const {
        options.insert(options.begin(), {"render", "scene.xml"});
        return run(options, file_size_limit);
    }
    float value(const Image &image, const char *channel) const { return image.find(channel)->values.at(0); }
};

TEST_F(Render, WritesTheImageWithItsMetadata) {
    const Outcome outcome = render({"-o", "out.exr", "--seed", "5"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(files(), ElementsAre("out.exr", "scene.xml"));
    const Image image = read_image(at("out.exr"));
    EXPECT_EQ(image.width, 8u);
    EXPECT_EQ(image.height, 6u);
    EXPECT_EQ(image.channels.size(), 3u);
    EXPECT_EQ(value(image, "R"), 5);
    EXPECT_EQ(value(image, "G"), 4);
    EXPECT_EQ(value(image, "B"), 0.5f);
    EXPECT_EQ(image.metadata.at("scene"), "scene.xml");
    EXPECT_EQ(image.metadata.at("method"), "gpt");
    EXPECT_EQ(image.metadata.at("precision"), "single");
    EXPECT_EQ(image.metadata.at("spp"), "4");
    EXPECT_EQ(image.metadata.at("seed"), "5");
    EXPECT_EQ(image.metadata.at("samples"), "192");
    EXPECT_EQ(image.metadata.at("version"), "0.1.0");
    EXPECT_EQ(image.metadata.at("device"), "fake device");
    EXPECT_EQ(image.metadata.at("partial"), "false");
    EXPECT_GE(std::stod(image.metadata.at("seconds")), 0);
    EXPECT_THAT(outcome.err, HasSubstr("compiled fake_kernel in 0.25 s (1 of 1)"));
    EXPECT_THAT(outcome.err, HasSubstr("100 %"));
    EXPECT_EQ(outcome.out, "");
}

TEST_F(Render, OptionsReplaceTheFilesSettings) {
    ASSERT_EQ(render({"-o", "out.exr", "--size", "20x10", "--crop", "15,4,5,6", "--spp", "2", "--aov"}).exit_code, 0);
    const Image image = read_image(at("out.exr"));
    EXPECT_EQ(image.width, 5u);
    EXPECT_EQ(image.height, 6u);
    EXPECT_EQ(value(image, "G"), 2);
    EXPECT_EQ(value(image, "albedo.R"), 0.25f);
    EXPECT_EQ(image.metadata.at("crop"), "15,4,5,6");
}

TEST_F(Render, WritesPngAndStatistics) {
    const Outcome outcome = render({"-o", "out.exr", "--png", "--stats", "out.json", "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(files(), ElementsAre("out.exr", "out.json", "out.png", "scene.xml"));
    EXPECT_NEAR(value(read_image(at("out.png")), "B"), 0.5f, 0.005f);
    const nlohmann::json statistics = nlohmann::json::parse(text_of("out.json"));
    EXPECT_EQ(statistics.at("samples"), 192);
    EXPECT_EQ(statistics.at("spp"), 4);
    EXPECT_EQ(statistics.at("stages").at(0).at("name"), "trace");
    EXPECT_EQ(statistics.at("stages").at(0).at("share"), 0.75);
    EXPECT_EQ(statistics.at("rays").at("extension").at("per_second"), 1000);
    EXPECT_EQ(statistics.at("interrupted"), false);
}

TEST_F(Render, StatisticsToStandardOutput) {
    const Outcome outcome = render({"-o", "out.exr", "--stats", "-"});
    ASSERT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(nlohmann::json::parse(outcome.out).at("method"), "gpt");
}

TEST_F(Render, SaysWhichMethodWasChosenAndWhy) {
    const Outcome outcome = render({"-o", "out.exr", "--method", "auto", "--stats", "-"});
    ASSERT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.err, HasSubstr("pilot of 6 samples a pixel, to choose the method\n"));
    EXPECT_THAT(outcome.err, HasSubstr("method gpt: it was told to\n"));
    EXPECT_EQ(read_image(at("out.exr")).metadata.at("method"), "gpt");
    const nlohmann::json statistics = nlohmann::json::parse(outcome.out), choice = statistics.at("choice");
    EXPECT_EQ(statistics.at("method"), "gpt");
    EXPECT_EQ(choice.at("method"), "gpt");
    EXPECT_EQ(choice.at("reason"), "it was told to");
    EXPECT_EQ(choice.at("pilot").at("spp"), 6);
    EXPECT_EQ(choice.at("pilot").at("seconds"), 0.5);
    EXPECT_EQ(choice.at("estimates").at("gpt").at("relative_mse"), 0.25);
    EXPECT_EQ(choice.at("estimates").at("pt").at("cost"), 3);
    EXPECT_EQ(choice.at("gain"), 4);
    EXPECT_EQ(render({"-o", "out.exr", "--method", "auto", "--quiet"}).err, "");
    EXPECT_THAT(render({"-o", "out.exr", "--method", "auto", "--time", "0.75", "--spp", "1"}).err,
                HasSubstr("method gpt: it was told to, within 0.75 s\n"));
}

TEST_F(Render, AMethodThatWasAskedForIsNoChoice) {
    const Outcome outcome = render({"-o", "out.exr", "--stats", "-"});
    EXPECT_FALSE(nlohmann::json::parse(outcome.out).contains("choice"));
}

TEST_F(Render, ThePilotCountsAsTime) {
    // The fake pilot says that it took half a second.
    ASSERT_EQ(render({"-o", "out.exr", "--method", "auto", "--time", "0.4", "-D", "batch_ms=10"}).exit_code, 0);
    const Image image = read_image(at("out.exr"));
    EXPECT_EQ(value(image, "G"), 1);
    EXPECT_GE(std::stod(image.metadata.at("seconds")), 0.5);
}

TEST_F(Render, TimeEndsTheRender) {
    const auto start = std::chrono::steady_clock::now();
    const Outcome outcome = render({"-o", "out.exr", "--time", "0.4", "-D", "batch_ms=10"});
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_GT(seconds, 0.4);
    EXPECT_LT(seconds, 5);
    const Image image = read_image(at("out.exr"));
    const float samples = value(image, "G");
    EXPECT_GT(samples, 4) << "the file's sample count is no limit";
    EXPECT_LE(samples, 41);
    EXPECT_EQ(std::stof(image.metadata.at("spp")), samples);
}

TEST_F(Render, ASampleOfEachPixelIsWaitedForLongerThanTheTime) {
    ASSERT_EQ(render({"-o", "out.exr", "--time", "0.01", "-D", "patient_ms=1500"}).exit_code, 0);
    EXPECT_EQ(value(read_image(at("out.exr")), "G"), 1);
}

// Both are waited for, for some seconds: at the same time.
TEST_F(Render, ASampleOfEachPixelIsNotWaitedForWithoutEnd) {
    ASSERT_EQ(render({"-o", "none.exr", "--time", "0.01"}).exit_code, 0);
    const std::string before = text_of("none.exr");
    const auto start = std::chrono::steady_clock::now();
    const auto begun = [&](const char *image, const std::vector<std::string> &definitions) {
        std::vector<std::string> arguments = {"render", "scene.xml", "-o", image, "--time", "0.01", "--seed", "3"};
        arguments.insert(arguments.end(), definitions.begin(), definitions.end());
        return std::make_unique<ChildProcess>(arguments, folder);
    };
    const auto without_samples = begun("none.exr", {"-D", "endless=0"});
    const auto with_holes = begun("holes.exr", {"-D", "endless=1", "-D", "holes=5"});

    const Outcome none = without_samples->wait(), holes = with_holes->wait();
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 20);
    EXPECT_EQ(none.exit_code, 1);
    EXPECT_THAT(none.err, HasSubstr("gradus: error: no sample was done"));
    EXPECT_EQ(text_of("none.exr"), before);

    EXPECT_EQ(holes.exit_code, 0);
    EXPECT_THAT(holes.err, HasSubstr("warning: the time was over before each pixel had a sample"));
    EXPECT_EQ(read_image(at("holes.exr")).metadata.at("partial"), "true");
}

TEST_F(Render, AnImageWithoutHolesIsWholeWhereTheTimeEndsIt) {
    ASSERT_EQ(render({"-o", "out.exr", "--time", "0.01", "-D", "endless=2", "-D", "holes=5"}).exit_code, 0);
    EXPECT_EQ(read_image(at("out.exr")).metadata.at("partial"), "false");
}

TEST_F(Render, ABatchThatTakesFarLongerThanTheTimeIsGivenUp) {
    ASSERT_EQ(render({"-o", "out.exr", "--time", "0.01", "-D", "endless=1"}).exit_code, 0);
    EXPECT_EQ(value(read_image(at("out.exr")), "G"), 1);
}

/// The error is first looked at after 16 samples a pixel: the time ends it before.
TEST_F(Render, TimeEndsARenderThatWaitsForItsError) {
    ASSERT_EQ(render({"-o", "out.exr", "--time", "0.1", "--until-error", "1e-6", "-D", "error=1", "-D", "endless=3"})
                  .exit_code,
              0);
    EXPECT_EQ(value(read_image(at("out.exr")), "G"), 3);
}

TEST_F(Render, SamplesEndATimedRenderWhereBothAreGiven) {
    ASSERT_EQ(render({"-o", "out.exr", "--time", "50", "--spp", "3"}).exit_code, 0);
    EXPECT_EQ(value(read_image(at("out.exr")), "G"), 3);
}

/// The fake error is 1 over the samples: at 32 it is 0.031, at 64 half of that.
TEST_F(Render, GoesOnUntilTheErrorIsSmallEnough) {
    const auto render_until = [&](std::vector<std::string> more) {
        more.insert(more.end(), {"-o", "out.exr", "--stats", "out.json", "-D", "error=1"});
        return render(more);
    };
    const auto statistics = [&] { return nlohmann::json::parse(text_of("out.json")); };
    for (const auto &[error, samples] : std::vector<std::pair<const char *, int>>{
             {"1", 16}, {"0.0625", 16}, {"0.0624", 32}, {"0.016", 64}, {"0.0009", 2048}}) {
        const Outcome outcome = render_until({"--until-error", error});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_EQ(statistics().at("spp"), samples) << "the file's sample count is no limit";
        EXPECT_EQ(statistics().at("stopped_by"), "error");
        EXPECT_EQ(statistics().at("estimated_error"), 1.0 / samples);
        EXPECT_THAT(outcome.err, HasSubstr("until the estimated relMSE is " + std::string(error)));
        EXPECT_THAT(outcome.err, HasSubstr(", estimated relMSE "));
        EXPECT_THAT(outcome.err, Not(HasSubstr("warning")));
        EXPECT_EQ(read_image(at("out.exr")).metadata.at("estimated_error"), fmt::format("{:.6g}", 1.0 / samples));
    }
    // What else ends it: samples, which may be enough between two looks, and time.
    Outcome outcome = render_until({"--until-error", "0.016", "--spp", "50"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(statistics().at("spp"), 50);
    EXPECT_EQ(statistics().at("stopped_by"), "samples");
    EXPECT_EQ(statistics().at("estimated_error"), 0.02);
    EXPECT_THAT(outcome.err, HasSubstr("warning: the samples were at their end before the error was small enough"));
    outcome = render_until({"--until-error", "0.0167", "--spp", "60"});
    EXPECT_EQ(statistics().at("spp"), 60);
    EXPECT_THAT(outcome.err, Not(HasSubstr("warning")));
    EXPECT_EQ(render_until({"--until-error", "1e-9", "--time", "0.3", "-D", "batch_ms=5"}).exit_code, 0);
    EXPECT_EQ(statistics().at("stopped_by"), "time");
    EXPECT_GT(statistics().at("spp"), 4);
    // An error that nobody knows is not small; without --error there is none.
    EXPECT_EQ(render({"-o", "out.exr", "--stats", "out.json", "--until-error", "1", "--spp", "40"}).exit_code, 0);
    EXPECT_EQ(statistics().at("spp"), 40);
    EXPECT_TRUE(statistics().at("estimated_error").is_null());
    EXPECT_EQ(render_until({}).exit_code, 0);
    EXPECT_EQ(statistics().at("stopped_by"), "samples");
    EXPECT_TRUE(statistics().at("estimated_error").is_null());
    EXPECT_EQ(read_image(at("out.exr")).metadata.count("estimated_error"), 0u);
}

TEST_F(Render, WarnsOfTheScene) {
    const Outcome outcome = render({"-o", "out.exr", "-D", "warn=a strange parameter"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.err, HasSubstr("warning: scene.xml:2: a strange parameter"));
}

TEST_F(Render, WarnsOfOptionsThatTheMethodDoesNotRead) {
    const auto warnings = [&](std::vector<std::string> options) {
        options.insert(options.end(), {"-o", "out.exr"});
        const Outcome outcome = render(options);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return outcome.err;
    };
    const auto changes_nothing = [](const std::string &option) {
        return HasSubstr("warning: " + option + " changes nothing with ");
    };
    const auto says = [&](std::vector<std::string> options, const std::string &option) {
        return warnings(options).find(option + " changes nothing with ") != std::string::npos;
    };
    EXPECT_THAT(warnings({"--method", "pt", "--layers"}),
                HasSubstr("gradus: warning: --layers changes nothing with pt: it is for gpt and gpm"));
    for (const char *option : {"--reconstruction=l1", "--norm=L2", "--shift-distance=0.1", "--shift-threshold=0",
                               "--photons=5", "--direct=photons", "--radius=1", "--radius-alpha=0.5",
                               "--gather-roughness=0.1", "--reconstruction=weighted"}) {
        const std::string name = std::string(option).substr(0, std::string(option).find('='));
        const bool is_of_shifts = name.starts_with("--shift");
        const bool is_of_reconstruction = name == "--reconstruction" || name == "--norm";
        EXPECT_TRUE(says({"--method", "pt", option}, name)) << option;
        EXPECT_EQ(says({option}, name), !is_of_shifts && !is_of_reconstruction) << option << " with gpt";
        EXPECT_EQ(says({"--method", "gpm", option}, name), is_of_shifts) << option << " with gpm";
    }
    EXPECT_THAT(warnings({"--method", "sppm", "--reconstruction", "guided", "--guide", "denoiser"}),
                changes_nothing("--guide"));
    EXPECT_THAT(warnings({"--method", "pt", "--reconstruction", "guided", "--guide", "filter", "--layers"}),
                Not(HasSubstr("changes nothing")));
    // auto may choose a method that reads them, but what is to be written depends on the choice.
    EXPECT_THAT(warnings({"--method", "auto", "--photons", "5", "--shift-distance", "0.1"}),
                Not(HasSubstr("changes nothing")));
    EXPECT_THAT(warnings({"--method", "auto", "--layers"}), Not(HasSubstr("changes nothing")));
    EXPECT_THAT(warnings({"--method", "auto", "--layers", "-D", "choice=pt"}), changes_nothing("--layers"));
}

TEST_F(Render, ValuesThatAreNotFiniteAreAnErrorAndNotInTheFile) {
    for (const char *partial : {"1000", "1e-9"}) {
        const Outcome outcome = render({"-o", "out.exr", "-D", "nan=1", "--quiet", "--write-partial", partial});
        EXPECT_EQ(outcome.exit_code, 1);
        const std::string said = "gradus: error: 1 pixels have a value that is NaN or infinite";
        EXPECT_THAT(outcome.err, HasSubstr(said));
        EXPECT_EQ(outcome.err.find(said), outcome.err.rfind(said)) << "said once";
        const Image image = read_image(at("out.exr"));
        EXPECT_EQ(value(image, "B"), 0);
        EXPECT_EQ(image.find("B")->values[1], 0.5f);
        EXPECT_EQ(image.find("G")->values[0], 4);
    }
}

TEST_F(Render, OutputsOverInputsOrEachOtherAreRefusedHoweverTheyAreWritten) {
    std::filesystem::create_directory(folder / "sub");
    std::filesystem::create_symlink("scene.xml", folder / "link.json");
    std::filesystem::create_symlink("new.exr", folder / "link.exr");
    std::filesystem::create_symlink(".", folder / "here");
    std::filesystem::create_hard_link(folder / "scene.xml", folder / "hard.json");
    const std::string scene = text_of("scene.xml");
    const std::vector<std::vector<std::string>> cases = {
        {"-o", "out.exr", "--stats", "scene.xml"},
        {"-o", "out.exr", "--stats", "./sub/../scene.xml"},
        {"-o", "out.exr", "--stats", at("scene.xml")},
        {"-o", "out.exr", "--stats", "link.json"},
        {"-o", "out.exr", "--stats", "hard.json"},
        {"-o", "out.exr", "--stats", "here/scene.xml"},
        {"-o", "out.exr", "--stats", "out.exr"},
        {"-o", "out.exr", "--stats", "sub/../out.exr"},
        {"-o", "new.exr", "--stats", "link.exr"},
        {"-o", "new.exr", "--stats", "here/new.exr"},
        {"-o", "out.exr", "--png", "--stats", "./out.png"},
    };
    for (std::vector<std::string> options : cases) {
        options.insert(options.end(), {"-D", "batch_ms=60000"});
        const Outcome outcome = render(options);
        EXPECT_EQ(outcome.exit_code, 2) << options[3] << ": " << outcome.err;
        EXPECT_EQ(text_of("scene.xml"), scene);
    }
    EXPECT_EQ(render({"-o", "link.exr"}).exit_code, 0) << "a link that leads elsewhere is none of these";
    EXPECT_TRUE(std::filesystem::is_regular_file(folder / "new.exr"));
}

/// Meshes and included files are inputs, too: the fake loader says that it read one.
TEST_F(Render, OutputsOverFilesThatTheSceneNamesAreRefused) {
    std::ofstream(folder / "mesh.ply") << "ply";
    const std::vector<std::string> options{"-D", "reads=mesh.ply", "-D",      "batch_ms=60000",
                                           "-o", "out.exr",        "--stats", "./mesh.ply"};
    const Outcome outcome = render(options);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("file to read"));
    EXPECT_EQ(text_of("mesh.ply"), "ply");
}

TEST_F(Render, TooManySamplesToCountAreRefused) {
    EXPECT_EQ(render({"-o", "out.exr", "-D", "spp=1099511627776", "--size", "4096x4096"}).exit_code, 2);
    EXPECT_EQ(render({"-o", "out.exr", "--spp", "1073741824", "--size", "65536x65536"}).exit_code, 2);
    EXPECT_THAT(files(), ElementsAre("scene.xml"));
}

TEST_F(Render, MemoryIsCheckedBeforeTheRender) {
    // 2^32 pixels of 240 bytes, and a frame of 48 for its Gaussian filter.
    const Outcome outcome = render({"-o", "out.exr", "--size", "65536x65536", "--spp", "1", "-D", "batch_ms=60000"});
    EXPECT_EQ(outcome.exit_code, 4);
    EXPECT_THAT(outcome.err, HasSubstr("not enough memory: rendering 65536x65536 pixels takes 1179809 MB"));
    EXPECT_THAT(files(), ElementsAre("scene.xml"));
}

/// Of gpt, which takes far more than pt, nobody knows before that it is to be the one.
TEST_F(Render, MemoryIsCheckedAgainForTheMethodThatWasChosen) {
    const double side = std::min(std::sqrt(double(bytes_left(0)) / 100), 65536.0); // pt takes 28 bytes a pixel, gpt 330
    const auto with = [&](const char *choice) {
        return render({"-o", "out.exr", "--method", "auto", "--size", fmt::format("{0:.0f}x{0:.0f}", side), "-D",
                       std::string("choice=") + choice, "-D", "fail=memory"});
    };
    const Outcome chosen = with("gpt");
    EXPECT_EQ(chosen.exit_code, 4);
    EXPECT_THAT(chosen.err, HasSubstr(" pixels by gpt, which was chosen, takes "));
    EXPECT_THAT(chosen.err, HasSubstr("try --method pt, "));
    EXPECT_THAT(with("pt").err, HasSubstr("out of memory")) << "it was to begin";
    EXPECT_THAT(files(), ElementsAre("scene.xml"));
}

TEST_F(Render, ThatStartsWhereNoFolderIsAnyMoreIsAnErrorOfItsOutput) {
    const std::string command = fmt::format("cd '{0}' && mkdir gone && cd gone && rmdir ../gone && '{1}' render "
                                            "'{0}/scene.xml' -o out.exr 2>'{0}/said'",
                                            folder.string(), GRADUS_PROGRAM);
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 5);
    EXPECT_THAT(text_of("said"), HasSubstr("gradus: error: cannot write 'out.exr': the working folder: "));
}

TEST_F(Render, WhatWasRenderedIsSavedWhereMemoryOrTheDeviceFails) {
    for (const char *fail : {"memory-later", "device-later"}) {
        std::filesystem::remove(at("out.exr"));
        const Outcome outcome = render({"-o", "out.exr", "--spp", "10", "-D", std::string("fail=") + fail});
        EXPECT_EQ(outcome.exit_code, 4);
        EXPECT_THAT(outcome.err, HasSubstr("wrote out.exr of what was rendered: 3 samples"));
        EXPECT_THAT(outcome.err, HasSubstr("gradus: error: "));
        const Image image = read_image(at("out.exr"));
        EXPECT_EQ(image.metadata.at("partial"), "true");
        EXPECT_EQ(value(image, "G"), 3);
    }
    // Nothing can be saved where the image itself does not fit.
    const Outcome outcome = render({"-o", "none.exr", "--spp", "10", "-D", "fail=memory-image"});
    EXPECT_EQ(outcome.exit_code, 4);
    EXPECT_FALSE(std::filesystem::exists(folder / "none.exr"));
    // Samples are there where what was to become of them fails.
    const Outcome mean =
        render({"-o", "mean.exr", "--spp", "3", "-D", "fail=reconstruction", "--write-partial", "1e-9"});
    EXPECT_EQ(mean.exit_code, 1);
    EXPECT_THAT(mean.err, HasSubstr("the fake guide is lost; the render goes on"));
    EXPECT_THAT(mean.err, HasSubstr("wrote mean.exr of what was rendered: 3 samples"));
    EXPECT_EQ(value(read_image(at("mean.exr")), "B"), 0.25);
    // An image under way is no reason to stop.
    EXPECT_EQ(render({"-o", "out.exr", "-D", "fail=memory-partial", "--write-partial", "1e-9"}).exit_code, 0);
}

/// The device is asked for statistics once more when the image is there.
TEST_F(Render, AnImageIsWrittenWhereItsStatisticsFail) {
    const Outcome outcome = render({"-o", "out.exr", "--png", "--stats", "out.json", "-D", "fail=statistics"});
    EXPECT_EQ(outcome.exit_code, 4);
    EXPECT_THAT(outcome.err, HasSubstr("warning: the image is written without its statistics: the fake device"));
    EXPECT_THAT(outcome.err, HasSubstr("gradus: error: the fake device is lost"));
    EXPECT_THAT(files(), ElementsAre("out.exr", "out.png", "scene.xml"));
    EXPECT_EQ(value(read_image(at("out.exr")), "G"), 4);
    EXPECT_EQ(read_image(at("out.exr")).metadata.at("partial"), "false");
}

/// A file of a run that was killed goes; one that somebody writes, or that is not ours, stays.
TEST_F(Render, AbandonedTemporaryFilesAreRemovedByTheNextRun) {
    std::ofstream(folder / ".gradus-1-0.part") << "abandoned";
    std::ofstream(folder / ".gradus-2-0.part") << "held";
    std::ofstream(folder / ".other.part") << "of another program";
    const int held = ::open((folder / ".gradus-2-0.part").c_str(), O_RDONLY | O_CLOEXEC);
    ASSERT_EQ(::flock(held, LOCK_EX), 0);
    ASSERT_EQ(render({"-o", "out.exr"}).exit_code, 0);
    EXPECT_THAT(files(), ElementsAre(".gradus-2-0.part", ".other.part", "out.exr", "scene.xml"));
    ::close(held);
    ASSERT_EQ(render({"-o", "out.exr"}).exit_code, 0);
    EXPECT_THAT(files(), ElementsAre(".other.part", "out.exr", "scene.xml"));
}

TEST_F(Render, OutputsAreCheckedBeforeTheRender) {
    // The batch would take a minute: only a check ahead of it can answer in time.
    const std::vector<std::vector<std::string>> cases = {{"-o", "missing/out.exr"},
                                                         {"-o", "/proc/out.exr"},
                                                         {"-o", "scene.xml/out.exr"},
                                                         {"-o", std::string(300, 'a') + ".exr"},
                                                         {"-o", "out.exr", "--stats", "missing/out.json"}};
    for (std::vector<std::string> options : cases) {
        options.insert(options.end(), {"-D", "batch_ms=60000"});
        const Outcome outcome = render(options);
        EXPECT_EQ(outcome.exit_code, 5) << options[1];
        EXPECT_THAT(outcome.err, HasSubstr("gradus: error: cannot write"));
        EXPECT_THAT(files(), ElementsAre("scene.xml"));
    }
    for (const char *dump : {"scene.xml", "/proc/kernels"})
        EXPECT_EQ(render({"-o", "out.exr", "--dump-kernels", dump, "-D", "batch_ms=60000"}).exit_code, 5) << dump;
    std::filesystem::create_directory(folder / "folder.exr");
    EXPECT_EQ(render({"-o", "folder.exr"}).exit_code, 5);
}

TEST_F(Render, AFullDiskLeavesNothingHalfWritten) {
    const Outcome outcome = render({"-o", "out.exr", "--size", "400x400"}, 600);
    EXPECT_EQ(outcome.exit_code, 5) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("File too large"));
    EXPECT_THAT(files(), ElementsAre("scene.xml"));
}

TEST_F(Render, AnImageThatCannotBeWrittenTakesNoStatisticsWithIt) {
    const Outcome outcome = render({"-o", "out.exr", "--size", "1000x1000", "--stats", "-"}, 5000);
    EXPECT_EQ(outcome.exit_code, 5) << outcome.err;
    EXPECT_EQ(nlohmann::json::parse(outcome.out).at("samples"), 4000000);
}

TEST_F(Render, AFailedWriteKeepsTheOldImage) {
    ASSERT_EQ(render({"-o", "out.exr", "--seed", "1"}).exit_code, 0);
    const std::string before = text_of("out.exr");
    EXPECT_EQ(render({"-o", "out.exr", "--seed", "2"}, 100).exit_code, 5);
    EXPECT_EQ(text_of("out.exr"), before);
    EXPECT_THAT(files(), ElementsAre("out.exr", "scene.xml"));
}

TEST_F(Render, ErrorsHaveTheirExitCodes) {
    EXPECT_EQ(run({"render", "none.xml", "-o", "out.exr"}).exit_code, 3);
    EXPECT_EQ(render({"-o", "out.png"}).exit_code, 2);
    EXPECT_EQ(render({"-o", "out.exr", "--crop", "4,0,5,1"}).exit_code, 2);
    EXPECT_EQ(render({"-o", "out.exr", "--stats", "out.exr"}).exit_code, 2);
    const Outcome memory = render({"-o", "out.exr", "-D", "fail=memory"});
    EXPECT_EQ(memory.exit_code, 4);
    EXPECT_THAT(memory.err, HasSubstr("out of memory"));
    const Outcome strange = render({"-o", "out.exr", "-D", "fail=strange"});
    EXPECT_EQ(strange.exit_code, 1);
    EXPECT_THAT(strange.err, HasSubstr("gradus: error: an exception of unknown type\n"));
    EXPECT_THAT(files(), ElementsAre("scene.xml"));
}

} // namespace
} // namespace gradus
