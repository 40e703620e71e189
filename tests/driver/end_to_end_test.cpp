// The program itself, on a scene that it reads, compiles and renders.
#include "runtime/film/metrics.h"
#include "runtime/io/image_io.h"
#include "tests/driver/child_process.h"
#include "tests/support/test_name.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>

namespace gradus {
namespace {

using ::testing::HasSubstr;

class EndToEnd : public ProgramTest {
  protected:
    const std::string scene = std::string(GRADUS_SCENES) + "/cornell-box.xml";

    std::vector<std::string> render(const std::string &output, std::vector<std::string> more) const {
        more.insert(more.begin(), {"render", scene, "-o", output, "--size", "32x32"});
        return more;
    }
    /// The same channels with the same values, bit for bit but for the sign of zero.
    void expect_equal_pixels(const std::string &first, const std::string &second) const {
        const Image a = read_image(at(first)), b = read_image(at(second));
        ASSERT_EQ(a.channels.size(), b.channels.size());
        for (const Channel &channel : a.channels)
            EXPECT_EQ(channel.values, b.find(channel.name)->values) << channel.name;
    }
};

TEST_F(EndToEnd, RendersWithLayersPictureAndStatistics) {
    const Outcome outcome = run(render("out.exr", {"--spp", "4", "--aov", "--png", "--stats", "out.json"}));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const Image image = read_image(at("out.exr"));
    for (const char *name : {"R", "G", "B", "albedo.R", "normal.X", "depth.Z", "variance.R"})
        EXPECT_NE(image.find(name), nullptr) << name;
    EXPECT_EQ(count_non_finite(image), 0u);
    EXPECT_GT(compare_means(image, image).image, 0.01) << "the image is black";
    EXPECT_EQ(image.metadata.at("spp"), "4");
    EXPECT_EQ(image.metadata.at("samples"), std::to_string(32 * 32 * 4));
    const nlohmann::json statistics = nlohmann::json::parse(text_of("out.json"));
    EXPECT_EQ(statistics.at("samples"), 32 * 32 * 4);
    EXPECT_GE(statistics.at("rays").at("extension").at("count").get<std::uint64_t>(), 32u * 32 * 4);
    EXPECT_GT(statistics.at("stages").size(), 3u);
    EXPECT_EQ(statistics.at("non_finite"), 0);
}

/// The image is that of so many samples, layers and all, and of any batch.
TEST_F(EndToEnd, GoesOnUntilTheErrorIsSmallEnough) {
    for (const char *reconstruction : {"l1", "guided"}) {
        const Outcome outcome = run(render("until.exr", {"--until-error", "0.01", "--reconstruction", reconstruction,
                                                         "--stats", "until.json", "--write-partial", "1e-9"}));
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        const nlohmann::json statistics = nlohmann::json::parse(text_of("until.json"));
        const int samples = statistics.at("spp");
        const double error = statistics.at("estimated_error");
        EXPECT_EQ(statistics.at("stopped_by"), "error");
        EXPECT_TRUE(samples == 16 || samples == 32 || samples == 64) << samples;
        EXPECT_GT(error, 0);
        EXPECT_LE(error, 0.01);
        ASSERT_EQ(run(render("spp.exr", {"--error", "--spp", std::to_string(samples), "--batch-size", "700",
                                         "--nthreads", "1", "--reconstruction", reconstruction}))
                      .exit_code,
                  0);
        expect_equal_pixels("until.exr", "spp.exr");
        EXPECT_NE(read_image(at("until.exr")).find("error.G"), nullptr);
    }
    const Outcome photons = run(render("x.exr", {"--until-error", "0.1", "--method", "sppm"}));
    EXPECT_EQ(photons.exit_code, 2);
    EXPECT_THAT(photons.err, HasSubstr("of pt and gpt"));
}

/// The channels of an image in the order of their names.
std::vector<std::string> names_of(const Image &image) {
    std::vector<std::string> names;
    for (const Channel &channel : image.channels)
        names.push_back(channel.name);
    std::sort(names.begin(), names.end());
    return names;
}

/// Compilers within OpenCL implementations take signals for themselves.
TEST_F(EndToEnd, ASignalThatWasIgnoredAtTheStartStaysIgnored) {
    ChildProcess process(
        render("out.exr", {"--method", "pt", "--spp", "1000000", "--time", "3", "--write-partial", "0.2"}), folder, 0,
        0, SIGHUP);
    ASSERT_TRUE(wait_for_file("out.exr"));
    process.send(SIGHUP);
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(read_image(at("out.exr")).metadata.at("partial"), "false");
}

/// PoCL waits for its linker, and would not learn how that ends. In workers and in the program itself.
TEST_F(EndToEnd, CompilesWhereTheEndsOfProcessesAreIgnored) {
    const char *const chosen = std::getenv("GRADUS_CACHE_DIR");
    const std::string before = chosen ? chosen : "";
    for (const std::string &cache : {at("cache"), std::string("off")}) {
        setenv("GRADUS_CACHE_DIR", cache.c_str(), 1);
        ChildProcess process({"render", scene, "-o", "out.exr", "--method", "pt", "--spp", "1", "--size", "4x4"},
                             folder, 0, 0, SIGCHLD);
        const Outcome outcome = process.wait();
        EXPECT_EQ(outcome.exit_code, 0) << cache << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr("compiled ")) << cache;
    }
    if (chosen)
        setenv("GRADUS_CACHE_DIR", before.c_str(), 1);
    else
        unsetenv("GRADUS_CACHE_DIR");
}

/// Ctrl-C and `timeout` send their signals to all processes of a group, the linker of PoCL in the program itself among
/// them.
TEST_F(EndToEnd, CompilesWhereSignalsReachTheLinker) {
    std::ofstream(at("sky.xml")) << R"(<scene version="3.0.0"><sensor type="perspective"/><emitter type="constant"/>
</scene>)";
    std::ofstream(at("ld")) << "#!/bin/sh\n>linked\nkill -INT $$\nkill -TERM $$\nkill -HUP $$\nexec ld \"$@\"\n";
    std::filesystem::permissions(at("ld"), std::filesystem::perms::owner_all);
    const std::string command =
        fmt::format("cd '{0}' && COMPILER_PATH='{0}' POCL_CACHE_DIR='{0}/pocl' GRADUS_CACHE_DIR=off "
                    "'{1}' render sky.xml -q -o out.exr --method pt --spp 1 --size 4x4",
                    folder.string(), GRADUS_PROGRAM);
    EXPECT_EQ(std::system(command.c_str()), 0);
    EXPECT_TRUE(std::filesystem::exists(at("linked")));
}

/// A cache is never an error.
TEST_F(EndToEnd, DoesWithoutACacheWhereTheFolderThatItIsInIsGone) {
    const std::string command =
        fmt::format("cd '{}' && mkdir gone && cd gone && rmdir ../gone && GRADUS_CACHE_DIR=some "
                    "'{}' devices >/dev/null",
                    folder.string(), GRADUS_PROGRAM);
    EXPECT_EQ(std::system(command.c_str()), 0);
}

/// Of methods that reconstruct their images.
class EndToEndLayers : public EndToEnd, public ::testing::WithParamInterface<const char *> {
  protected:
    Outcome render_with(const std::string &output, std::vector<std::string> more) const {
        more.insert(more.end(), {"--spp", "4", "--method", GetParam(), "--photons", "2000"});
        return run(render(output, more));
    }
};

TEST_P(EndToEndLayers, AreWrittenOnlyOnRequest) {
    using ::testing::ElementsAre;
    ASSERT_EQ(render_with("plain.exr", {"--reconstruction", "l1"}).exit_code, 0);
    ASSERT_EQ(render_with("aov.exr", {"--reconstruction", "l1", "--aov"}).exit_code, 0);
    ASSERT_EQ(render_with("layers.exr", {"--reconstruction", "l1", "--layers"}).exit_code, 0);
    ASSERT_EQ(render_with("all.exr", {"--reconstruction", "l1", "--layers", "--aov"}).exit_code, 0);
    const Image plain = read_image(at("plain.exr")), layers = read_image(at("layers.exr"));
    EXPECT_THAT(names_of(plain), ElementsAre("B", "G", "R"));
    const std::size_t bias = std::string(GetParam()) == "gpm" ? 3 : 0;
    EXPECT_EQ(read_image(at("aov.exr")).channels.size(), 3u + 10 + bias); // albedo, normal, depth, variance
    EXPECT_THAT(names_of(layers), ElementsAre("B", "G", "R", "direct.B", "direct.G", "direct.R", "dx.B", "dx.G", "dx.R",
                                              "dy.B", "dy.G", "dy.R", "primal.B", "primal.G", "primal.R"));
    const Image all = read_image(at("all.exr"));
    EXPECT_EQ(all.channels.size(), 3u + 10 + bias + 12 + 9);
    for (const Channel &channel : plain.channels)
        EXPECT_EQ(channel.values, layers.find(channel.name)->values);
    // The layers are what the image was made from, bit for bit.
    ASSERT_EQ(run({"solve", "all.exr", "-o", "again.exr", "--alpha", "auto", "-q"}).exit_code, 0);
    const Image again = read_image(at("again.exr"));
    for (const Channel &channel : again.channels)
        EXPECT_EQ(channel.values, all.find(channel.name)->values);
    EXPECT_EQ(again.metadata.at("alpha"), all.metadata.at("alpha"));
    // And without them there is nothing to make it from.
    EXPECT_EQ(run({"solve", "plain.exr", "-o", "again.exr"}).exit_code, 6);
}

TEST_P(EndToEndLayers, HaveBothHalvesForTheWeightedReconstruction) {
    ASSERT_EQ(
        render_with("halves.exr", {"--reconstruction", "weighted", "--layers", "--stats", "halves.json"}).exit_code, 0);
    const Image image = read_image(at("halves.exr"));
    EXPECT_EQ(image.channels.size(), 3u + 12 + 36);
    const char *const accuracy = std::string(GetParam()) == "gpm" ? "consistent" : "unbiased";
    EXPECT_EQ(image.metadata.at("reconstruction"), "weighted");
    EXPECT_EQ(image.metadata.at("accuracy"), accuracy);
    const nlohmann::json used = nlohmann::json::parse(text_of("halves.json")).at("reconstruction");
    EXPECT_EQ(used.at("name"), "weighted");
    EXPECT_EQ(used.at("accuracy"), accuracy);
    EXPECT_EQ(used.at("note"), "");
    EXPECT_TRUE(used.at("alpha").is_null());
    EXPECT_EQ(image.metadata.count("alpha"), 0u);
    ASSERT_EQ(run({"solve", "halves.exr", "-o", "again.exr", "--reconstruction", "weighted", "-q"}).exit_code, 0);
    const Image again = read_image(at("again.exr"));
    for (const char *color : {"R", "G", "B"})
        EXPECT_EQ(image.find(color)->values, again.find(color)->values);
    EXPECT_EQ(again.metadata.at("reconstruction"), "weighted");

    const Outcome alpha = render_with("x.exr", {"--reconstruction", "weighted", "--alpha", "0.2"});
    EXPECT_EQ(alpha.exit_code, 2);
    EXPECT_THAT(alpha.err, ::testing::HasSubstr("--alpha"));
    EXPECT_EQ(run({"solve", "halves.exr", "-o", "x.exr", "--reconstruction", "weighted", "--method", "cg"}).exit_code,
              2);
    EXPECT_EQ(render_with("x.exr", {"--reconstruction", "l1", "--norm", "L1"}).exit_code, 2);
    ASSERT_EQ(render_with("plain.exr", {"--reconstruction", "l1", "--layers"}).exit_code, 0);
    const Outcome none = run({"solve", "plain.exr", "-o", "x.exr", "--reconstruction", "weighted"});
    EXPECT_EQ(none.exit_code, 6);
    EXPECT_THAT(none.err, ::testing::HasSubstr("primal_even"));
}

/// With a filter samples are taken around the image, too. Of five the halves have three and two.
TEST_P(EndToEndLayers, AreOfTheImageAloneWithAFilter) {
    ASSERT_EQ(run(render("halves.exr", {"-D", "rfilter=gaussian", "--spp", "5", "--method", GetParam(), "--photons",
                                        "2000", "--reconstruction", "weighted", "--layers"}))
                  .exit_code,
              0);
    EXPECT_EQ(read_image(at("halves.exr")).metadata.at("layer_samples"), std::to_string(5 * 32 * 32));
    ASSERT_EQ(run({"solve", "halves.exr", "-o", "again.exr", "--reconstruction", "weighted", "-q"}).exit_code, 0);
    const Image image = read_image(at("halves.exr")), again = read_image(at("again.exr"));
    for (const char *color : {"R", "G", "B"})
        EXPECT_EQ(image.find(color)->values, again.find(color)->values);
}

INSTANTIATE_TEST_SUITE_P(Methods, EndToEndLayers, ::testing::Values("gpt", "gpm"), testing::name_of_method);

class EndToEndGuided : public EndToEndLayers {};

TEST_P(EndToEndGuided, LayersMakeTheImageAgain) {
    ASSERT_EQ(render_with("halves.exr", {"--reconstruction", "guided", "--layers"}).exit_code, 0);
    const Image image = read_image(at("halves.exr"));
    // albedo, normal and depth, halves of the primal; of gradients also both halves' rest, and what all of
    // the samples and lights that are seen have
    EXPECT_EQ(image.channels.size(), 3u + 7 + (std::string(GetParam()) == "pt" ? 6 : 12 + 36));
    const Outcome solved = run({"solve", "halves.exr", "-o", "again.exr", "--reconstruction", "guided"});
    ASSERT_EQ(solved.exit_code, 0);
    EXPECT_EQ(solved.err, ""); // no warning of a system that there is not
    EXPECT_EQ(solved.out.find("converged") == std::string::npos, std::string(GetParam()) == "pt") << solved.out;
    const Image again = read_image(at("again.exr"));
    for (const char *color : {"R", "G", "B"})
        EXPECT_EQ(image.find(color)->values, again.find(color)->values);
    EXPECT_EQ(again.metadata.at("guide"), "filter");
    const Outcome unguided = run({"solve", "halves.exr", "-o", "x.exr", "--guide", "filter"});
    EXPECT_EQ(unguided.exit_code, 2);
    EXPECT_THAT(unguided.err, ::testing::HasSubstr("--reconstruction guided"));
}

TEST_P(EndToEndGuided, LayersMakeAFilteredImageAgain) {
    ASSERT_EQ(run(render("halves.exr", {"-D", "rfilter=gaussian", "--spp", "5", "--method", GetParam(), "--photons",
                                        "2000", "--reconstruction", "guided", "--layers"}))
                  .exit_code,
              0);
    ASSERT_EQ(run({"solve", "halves.exr", "-o", "again.exr", "--reconstruction", "guided"}).exit_code, 0);
    const Image image = read_image(at("halves.exr")), again = read_image(at("again.exr"));
    for (const char *color : {"R", "G", "B"})
        EXPECT_EQ(image.find(color)->values, again.find(color)->values);
}

/// Interrupted during its first frame, of the upper rows alone: each batch has an image written, which takes a while.
TEST_F(EndToEnd, LayersOfAStoppedRenderMakeItsImageAgain) {
    for (const char *filter : {"box", "gaussian"}) {
        ChildProcess process({"render", scene, "-o", "part.exr", "--size", "256x256", "-D",
                              std::string("rfilter=") + filter, "--method", "gpt", "--reconstruction", "l1", "--spp",
                              "16", "--batch-size", "2000", "--layers", "--write-partial", "1e-9"},
                             folder);
        ASSERT_TRUE(wait_for_file("part.exr"));
        process.send(SIGINT);
        EXPECT_EQ(process.wait().exit_code, 130);
        const Image image = read_image(at("part.exr"));
        const std::uint64_t samples = std::stoull(image.metadata.at("layer_samples"));
        ASSERT_LT(samples, 256u * 256) << "it went on for too long";
        EXPECT_GT(samples, 256u);
        EXPECT_EQ(image.metadata.at("alpha"), "0.2") << "as `gradus solve` has it";
        const Outcome solved = run({"solve", "part.exr", "-o", "again.exr"});
        ASSERT_EQ(solved.exit_code, 0) << solved.err;
        EXPECT_THAT(solved.err, HasSubstr("was stopped before each pixel had a sample"));
        const Image again = read_image(at("again.exr"));
        for (const char *color : {"R", "G", "B"})
            EXPECT_EQ(image.find(color)->values, again.find(color)->values) << filter;
        std::filesystem::remove(at("part.exr"));
    }
}

TEST_F(EndToEnd, ACropOfAllIsNone) {
    ASSERT_EQ(run(render("whole.exr", {"--method", "pt", "--spp", "1", "--crop", "0,0,32,32"})).exit_code, 0);
    EXPECT_EQ(read_image(at("whole.exr")).metadata.count("crop"), 0u);
    ASSERT_EQ(run(render("crop.exr", {"--method", "pt", "--spp", "1", "--crop", "0,0,32,31"})).exit_code, 0);
    EXPECT_EQ(read_image(at("crop.exr")).metadata.at("crop"), "0,0,32,31");
}

INSTANTIATE_TEST_SUITE_P(Methods, EndToEndGuided, ::testing::Values("pt", "gpt", "gpm"), testing::name_of_method);

TEST_F(EndToEnd, TheImageDependsOnTheSeedAndNotOnThreadsOrBatches) {
    ASSERT_EQ(run(render("first.exr", {"--spp", "4", "--seed", "3"})).exit_code, 0);
    ASSERT_EQ(
        run(render("second.exr", {"--spp", "4", "--seed", "3", "--nthreads", "1", "--batch-size", "1024"})).exit_code,
        0);
    ASSERT_EQ(run(render("third.exr", {"--spp", "4", "--seed", "4"})).exit_code, 0);
    expect_equal_pixels("first.exr", "second.exr");
    EXPECT_GT(relative_mse(read_image(at("first.exr")), read_image(at("third.exr"))), 0);
}

/// A cache folder of the test's own.
class EndToEndTuning : public EndToEnd {
  protected:
    void SetUp() override {
        EndToEnd::SetUp();
        setenv("XDG_CACHE_HOME", at("cache").c_str(), 1);
    }
    void TearDown() override {
        unsetenv("XDG_CACHE_HOME");
        EndToEnd::TearDown();
    }
    void write_tuning(const std::string &text) const {
        std::filesystem::create_directories(folder / "cache" / "gradus");
        std::ofstream(folder / "cache" / "gradus" / "tuning.json") << text;
    }
    nlohmann::json devices() const { return nlohmann::json::parse(run({"devices", "--json"}).out); }
};

TEST_F(EndToEndTuning, ATunedRenderHasTheSameImage) {
    ASSERT_EQ(run(render("default.exr", {"--spp", "4", "--method", "pt"})).exit_code, 0);
    nlohmann::json entries = nlohmann::json::array();
    for (const nlohmann::json &device : devices()) {
        EXPECT_EQ(device.at("tuning"), nullptr);
        entries.push_back({{"platform", device.at("platform")},
                           {"name", device.at("name")},
                           {"driver", device.at("driver")},
                           {"compute_units", device.at("compute_units")},
                           {"work_group_size", 128},
                           {"batch_size", 640}});
    }
    write_tuning(nlohmann::json{{"version", 1}, {"devices", entries}}.dump());
    EXPECT_EQ(devices().at(0).at("tuning").at("batch_size"), 640);
    EXPECT_THAT(run({"devices"}).out, HasSubstr("work-groups 128, batches 640"));
    const Outcome tuned = run(render("tuned.exr", {"--spp", "4", "--method", "pt", "--dump-kernels", "kernels"}));
    ASSERT_EQ(tuned.exit_code, 0) << tuned.err;
    EXPECT_THAT(text_of("kernels/camera.cl"), HasSubstr("-D WORK_GROUP_SIZE=128")) << "the tuning was not used";
    expect_equal_pixels("default.exr", "tuned.exr");
}

TEST_F(EndToEndTuning, RendersWhereTheTuningIsDamaged) {
    write_tuning("{\"version\": 1, \"devices\": [{");
    const Outcome outcome = run(render("out.exr", {"--spp", "1"}));
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.err, HasSubstr("warning"));
    EXPECT_THAT(outcome.err, HasSubstr("tuning.json"));
    EXPECT_THAT(run({"devices"}).out, HasSubstr("tuned        no: "));
}

/// Each candidate compiles its kernels anew; the tuner itself has tests of its own.
class FullEndToEndTuning : public EndToEndTuning {};

TEST_F(FullEndToEndTuning, TuneKeepsWhatItFinds) {
    const Outcome outcome = run({"tune", scene, "--size", "48x48", "--max-depth", "2"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("tuning.json"));
    EXPECT_THAT(outcome.err, HasSubstr("times as fast"));
    EXPECT_THAT(outcome.err, ::testing::Not(HasSubstr("another image")));
    EXPECT_NE(devices().at(0).at("tuning"), nullptr);
}

TEST_F(EndToEndTuning, TuneSaysWhereItCannotKeepAnything) {
    std::ofstream(folder / "cache") << "in the way";
    const Outcome rendered = run(render("out.exr", {"--spp", "1"}));
    EXPECT_EQ(rendered.exit_code, 0) << rendered.err;
    const Outcome tuned = run({"tune", scene, "--size", "48x48"});
    EXPECT_EQ(tuned.exit_code, 5);
    EXPECT_THAT(tuned.err, HasSubstr("error"));
}

TEST_F(EndToEnd, ACropIsThatPartOfTheImage) {
    ASSERT_EQ(run(render("full.exr", {"--method", "pt", "--spp", "4"})).exit_code, 0);
    ASSERT_EQ(run(render("crop.exr", {"--method", "pt", "--spp", "4", "--crop", "9,4,7,5"})).exit_code, 0);
    const Image full = read_image(at("full.exr")), crop = read_image(at("crop.exr"));
    ASSERT_EQ(crop.width, 7u);
    ASSERT_EQ(crop.height, 5u);
    for (const char *name : {"R", "G", "B"})
        for (std::uint32_t y = 0; y < 5; ++y)
            for (std::uint32_t x = 0; x < 7; ++x)
                EXPECT_EQ(crop.find(name)->values[y * 7 + x], full.find(name)->values[(y + 4) * 32 + x + 9]);
}

/// What ends a render early, for each method: gpt and gpm keep their film in another form, samples of sppm and gpm are
/// passes.
class EndToEndOf : public EndToEnd, public ::testing::WithParamInterface<const char *> {
  protected:
    std::vector<std::string> render_early(std::vector<std::string> more) const {
        more.insert(more.end(), {"--method", GetParam(), "--photons", "2000"});
        return render("out.exr", more);
    }
    /// Lit, and of as many samples as it says.
    void expect_valid_image() const {
        const Image image = read_image(at("out.exr"));
        EXPECT_EQ(image.metadata.at("method"), GetParam());
        EXPECT_EQ(count_non_finite(image), 0u);
        EXPECT_GT(std::stoull(image.metadata.at("samples")), 0u);
        EXPECT_NEAR(std::stod(image.metadata.at("spp")), std::stod(image.metadata.at("samples")) / (32 * 32), 1e-4);
        // Of the box at this size: a division by another count of passes would show.
        const double mean = compare_means(image, image).image;
        EXPECT_GT(mean, 0.5 * box_mean);
        EXPECT_LT(mean, 2 * box_mean);
    }
    static constexpr double box_mean = 0.26;
};

TEST_P(EndToEndOf, AnInterruptLeavesAValidImage) {
    ChildProcess process(render_early({"--spp", "1000000", "--write-partial", "0.05"}), folder);
    ASSERT_TRUE(wait_for_file("out.exr"));
    expect_valid_image(); // the partial one
    EXPECT_EQ(read_image(at("out.exr")).metadata.at("partial"), "true");
    process.send(SIGINT);
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
    expect_valid_image();
    EXPECT_LT(std::stoull(read_image(at("out.exr")).metadata.at("samples")), 32u * 32 * 1000000);
}

TEST_P(EndToEndOf, TimeEndsTheRender) {
    double samples_a_pixel = 0;
    for (const double time : {0.5, 4.0}) { // a busy machine may need half a second for the first sample
        const Outcome outcome = run(render_early({"--time", fmt::to_string(time)}));
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        const Image image = read_image(at("out.exr"));
        EXPECT_GE(std::stod(image.metadata.at("seconds")), time);
        EXPECT_LT(std::stod(image.metadata.at("seconds")), 10 * time);
        expect_valid_image();
        samples_a_pixel = std::stod(image.metadata.at("spp"));
        if (samples_a_pixel > 1)
            break;
    }
    EXPECT_GT(samples_a_pixel, 1);
}

/// Facing mirrors, of which no ray and no roulette frees a path.
constexpr const char *endless_scene = R"(<scene version="3.0.0">
  <integrator type="path"><integer name="rr_depth" value="1000000"/></integrator>
  <sensor type="perspective"><film type="hdrfilm"><rfilter type="box"/></film></sensor>
  <emitter type="constant"/>
  <shape type="sphere"><float name="radius" value="2"/><boolean name="flip_normals" value="true"/>
    <bsdf type="conductor"><string name="material" value="none"/></bsdf></shape>
</scene>
)";

// A batch of this scene takes minutes; a sample of each pixel is waited for, but for five seconds only.
TEST_F(EndToEnd, ABatchThatDoesNotEndIsGivenUp) {
    std::ofstream(at("endless.xml")) << endless_scene;
    const Outcome outcome = run({"render", at("endless.xml"), "-o", "out.exr", "--method", "pt", "--size", "128x128",
                                 "--time", "0.2", "--stats", "out.json"});
    ASSERT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("no sample was done after 5 s"));
    EXPECT_FALSE(std::filesystem::exists(at("out.exr")));
}

INSTANTIATE_TEST_SUITE_P(Methods, EndToEndOf, ::testing::Values("pt", "gpt", "sppm", "gpm"), testing::name_of_method);

/// A ball before the camera, of a BSDF and with a light or without one.
class EndToEndPhotons : public EndToEnd {
  protected:
    Outcome render_ball(const std::string &bsdf, const std::string &light, std::vector<std::string> more = {}) const {
        std::ofstream(folder / "ball.xml")
            << "<scene version=\"3.0.0\">"
            << "<sensor type=\"perspective\"><float name=\"far_clip\" value=\"" << 10 * size
            << "\"/><transform name=\"to_world\"><lookat origin=\"0, 0, " << 4 * size
            << "\" target=\"0, 0, 0\" up=\"0, 1, 0\"/>"
            << "</transform></sensor>" << light << "<shape type=\"sphere\"><float name=\"radius\" value=\"" << size
            << "\"/>" << bsdf << "</shape></scene>";
        more.insert(more.begin(), {"render", "ball.xml", "-o", "out.exr", "--method", method, "--size", "16x16",
                                   "--spp", "3", "--photons", "500"});
        return run(more);
    }
    const std::string light = "<emitter type=\"constant\"/>", gray = "<bsdf type=\"diffuse\"/>";
    std::string method = "sppm";
    double size = 1; // the ball's radius
    const std::string metal = "<bsdf type=\"roughconductor\"><float name=\"alpha\" value=\"0.02\"/></bsdf>";
};

TEST_F(EndToEndPhotons, WhereNothingCanBeGatheredTheErrorSaysWhy) {
    for (const char *name : {"sppm", "gpm"}) {
        method = name;
        const Outcome smooth = render_ball(metal, light);
        EXPECT_EQ(smooth.exit_code, 2);
        EXPECT_THAT(smooth.err, HasSubstr("no surface is rough enough to gather photons at: roughness 0.05 or more; "
                                          "--gather-roughness asks for less"));
        const Outcome dark = render_ball(gray, "");
        EXPECT_EQ(dark.exit_code, 2);
        EXPECT_THAT(dark.err, HasSubstr("there is no light in the scene"));
    }
    EXPECT_FALSE(std::filesystem::exists(at("out.exr")));
    for (const std::vector<std::string> &bad : std::vector<std::vector<std::string>>{{"--radius", "0"},
                                                                                     {"--radius", "-1%"},
                                                                                     {"--radius-alpha", "0"},
                                                                                     {"--radius-alpha", "1.5"},
                                                                                     {"--photons", "-1"},
                                                                                     {"--gather-roughness", "2"},
                                                                                     {"--direct", "magic"}}) {
        const Outcome outcome = render_ball(gray, light, bad);
        EXPECT_EQ(outcome.exit_code, 2) << bad[0] << " " << bad[1];
        EXPECT_THAT(outcome.err, HasSubstr(bad[0]));
    }
}

class FullEndToEndPhotons : public EndToEndPhotons {};

TEST_F(FullEndToEndPhotons, AreGatheredWhereTheRoughnessThatIsAskedForIsThere) {
    const Outcome rougher = render_ball(metal, light, {"--gather-roughness", "0.01"});
    EXPECT_EQ(rougher.exit_code, 0) << rougher.err;
}

TEST_F(EndToEndPhotons, StatisticsSayWhatIsGathered) {
    const Outcome outcome = render_ball(gray, light, {"--stats", "-", "--aov", "--radius-alpha", "0.5"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const nlohmann::json gathering = nlohmann::json::parse(outcome.out).at("gathering");
    EXPECT_EQ(gathering.at("gathered_at"), (nlohmann::json{{"diffuse", 1}}));
    EXPECT_EQ(gathering.at("passed_at"), nlohmann::json::object());
    // Squares of radii: the product of (k + alpha) / (k + 1) for k = 1 and 2.
    const double first = gathering.at("mean_radius_of_first_pass"), last = gathering.at("mean_radius_of_last_pass");
    EXPECT_GT(first, 0);
    EXPECT_NEAR(last / first, std::sqrt(1.5 / 2 * 2.5 / 3), 0.01);
    EXPECT_NEAR(gathering.at("mean_radius").get<double>(), first * (1 + std::sqrt(0.75) + last / first) / 3,
                0.01 * first);
    // As the image has it.
    const Image image = read_image(at("out.exr"));
    double sum = 0;
    for (const char *color : {"R", "G", "B"})
        for (std::size_t i = 0; i < 256; ++i)
            sum += image.find(std::string("variance.") + color)->values[i] /
                   (std::pow(image.find(color)->values[i], 2) + 0.001) / 768;
    EXPECT_GT(sum, 0);
    EXPECT_NEAR(gathering.at("relative_variance"), sum, 1e-5 * sum);
    EXPECT_TRUE(gathering.at("relative_squared_bias").is_number());
    EXPECT_NE(image.find("bias.G"), nullptr);
}

/// Also where the scene is rendered in another unit.
TEST_F(EndToEndPhotons, StatisticsHaveTheUnitOfTheScene) {
    const std::vector<std::string> names = {"mean_radius", "mean_radius_of_first_pass", "mean_radius_of_last_pass"};
    std::vector<double> radii;
    for (const double unit : {1.0, 1e7}) {
        size = unit;
        const Outcome outcome = render_ball(gray, light, {"--stats", "-"});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        const nlohmann::json gathering = nlohmann::json::parse(outcome.out).at("gathering");
        for (std::size_t i = 0; i < names.size(); ++i) {
            const double radius = gathering.at(names[i]).get<double>() / unit;
            if (radii.size() < names.size())
                radii.push_back(radius);
            EXPECT_NEAR(radius, radii[i], 1e-3 * radii[i]) << names[i];
        }
    }
}

TEST_F(EndToEndPhotons, InspectSaysWhatIsGathered) {
    render_ball(metal, light);
    EXPECT_THAT(run({"inspect", "ball.xml"}).out,
                HasSubstr("photons     gathered at none; camera and light paths go on at 1 roughconductor_"));
    const nlohmann::json json =
        nlohmann::json::parse(run({"inspect", "ball.xml", "--json", "--gather-roughness", "0.02"}).out);
    EXPECT_EQ(json.at("gathering").at("gathered_at").size(), 1u);
    EXPECT_EQ(json.at("gathering").at("passed_at").size(), 0u);
}

TEST_F(EndToEnd, InspectDevicesAndWarm) {
    const Outcome inspect = run({"inspect", scene});
    EXPECT_EQ(inspect.exit_code, 0) << inspect.err;
    EXPECT_THAT(inspect.out, HasSubstr("diffuse"));
    const nlohmann::json devices = nlohmann::json::parse(run({"devices", "--json"}).out);
    ASSERT_FALSE(devices.empty());
    EXPECT_NE(devices.at(0).at("name"), "");
    const Outcome warm = run({"warm", scene, "--size", "32x32", "--spp", "1"});
    EXPECT_EQ(warm.exit_code, 0) << warm.err;
}

// What single precision cannot see is refused as by a render.
TEST_F(EndToEnd, WarmRefusesWhatARenderDoes) {
    std::ofstream(folder / "tiny.xml") << R"(<scene version="3.0.0">
        <sensor type="perspective"/>
        <shape type="sphere"/>
        <shape type="sphere"><float name="radius" value="1e-12"/></shape>
        </scene>)";
    for (const char *command : {"warm", "tune"}) {
        const Outcome outcome = run({command, "tiny.xml", "--size", "8x8"});
        EXPECT_EQ(outcome.exit_code, 3) << command;
        EXPECT_THAT(outcome.err, HasSubstr("too small a share")) << command;
    }
}

/// Files and sockets that it opens do not take their places: all kernels are kept, and none is compiled again.
TEST_F(EndToEnd, DoesWithoutStandardStreams) {
    const auto kernels_compiled = [&] {
        const std::string command = fmt::format(
            "cd '{}' && GRADUS_CACHE_DIR='{}' '{}' render '{}' --method pt --size 4x4 --spp 1 --stats s.json "
            "-o out.exr <&- >&- 2>&-",
            folder.string(), at("cache"), GRADUS_PROGRAM, scene);
        EXPECT_EQ(std::system(command.c_str()), 0);
        return nlohmann::json::parse(text_of("s.json")).at("compile_seconds").at("kernels").size();
    };
    EXPECT_GT(kernels_compiled(), 0u);
    EXPECT_EQ(kernels_compiled(), 0u);
}

TEST_F(EndToEnd, MistakesHaveTheirExitCodes) {
    EXPECT_EQ(run({"render", "none.xml", "-o", "out.exr"}).exit_code, 3);
    EXPECT_EQ(run(render("out.exr", {"--device", "no such device"})).exit_code, 4);
    EXPECT_EQ(run(render("missing/out.exr", {})).exit_code, 5);
}

} // namespace
} // namespace gradus
