// `gradus compare` as a process: figures, verdict and exit codes.
#include "runtime/error.h"
#include "runtime/io/image_io.h"
#include "tests/driver/child_process.h"
#include "tests/film/make_image.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <random>

namespace gradus {
namespace {

using ::testing::HasSubstr;

class Compare : public ProgramTest {
  protected:
    static constexpr std::uint32_t side = 64;

    /// A gray 1 with noise of that deviation; `error` is added to one block of 16 x 16.
    void write_noise(const std::string &name, unsigned seed, double deviation, float error, const char *spp) const {
        std::mt19937 generator(seed);
        std::normal_distribution<double> noise(1, deviation);
        Image image = make_gray(side, side, std::vector<float>(side * side));
        for (Channel &channel : image.channels)
            for (std::size_t i = 0; i < channel.values.size(); ++i)
                channel.values[i] = float(noise(generator)) + (i % side < 16 && i / side < 16 ? error : 0);
        image.metadata["seed"] = std::to_string(seed);
        if (spp)
            image.metadata["spp"] = spp;
        write_image(image, at(name));
    }
    /// Eight images of 64 samples, a reference of 6400 and its variance; one sample has deviation 1.
    void write_set(float error) const {
        for (unsigned seed = 1; seed <= 8; ++seed)
            write_noise("seed" + std::to_string(seed) + ".exr", seed, 1.0 / 8, error, "64");
        write_noise("reference.exr", 100, 1.0 / 80, 0, nullptr);
        write_image(make_gray(side, side, std::vector<float>(side * side, 1.0f / 6400)), at("variance.exr"));
    }
    std::vector<std::string> all(std::vector<std::string> more) const {
        std::vector<std::string> arguments{"compare"};
        for (int seed = 1; seed <= 8; ++seed)
            arguments.push_back("seed" + std::to_string(seed) + ".exr");
        arguments.push_back("reference.exr");
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    }
};

TEST_F(Compare, CropsOfDifferentPlacesHaveNothingInCommon) {
    Image image = make_gray(side, side, std::vector<float>(side * side, 1));
    write_image(image, at("reference.exr"));
    image.metadata["crop"] = "0,0,64,64";
    write_image(image, at("first.exr"));
    image.metadata["crop"] = "64,0,64,64";
    write_image(image, at("second.exr"));
    const Outcome outcome = run({"compare", "first.exr", "second.exr"});
    EXPECT_EQ(outcome.exit_code, 6);
    EXPECT_THAT(outcome.err, HasSubstr("'first.exr' is the crop 0,0,64,64 of an image, and 'second.exr' is the crop "
                                       "64,0,64,64 of an image: they have not the same pixels"));
    EXPECT_EQ(run({"compare", "first.exr", "first.exr"}).exit_code, 0);
    EXPECT_EQ(run({"compare", "first.exr", "reference.exr"}).exit_code, 0) << "which does not say";
    EXPECT_EQ(run({"compare", "first.exr", "second.exr", "reference.exr"}).exit_code, 6) << "they say it of each other";
    EXPECT_EQ(run({"compare", "first.exr", "reference.exr", "--variance", "reference.exr"}).exit_code, 0);
    const Outcome variance = run({"compare", "reference.exr", "first.exr", "--variance", "second.exr"});
    EXPECT_EQ(variance.exit_code, 6);
    EXPECT_THAT(variance.err, HasSubstr("second.exr"));
}

/// Renders say where they are crops, so that one of ours without a word of it is whole.
TEST_F(Compare, ACropIsNoWholeImage) {
    Image image = make_gray(side, side, std::vector<float>(side * side, 1));
    image.metadata = {{"version", "1"}, {"scene", "scene.xml"}};
    write_image(image, at("whole.exr"));
    image.metadata["crop"] = "64,0,64,64";
    write_image(image, at("crop.exr"));
    for (const auto &[first, second] : {std::pair{"whole.exr", "crop.exr"}, {"crop.exr", "whole.exr"}}) {
        const Outcome outcome = run({"compare", first, second});
        EXPECT_EQ(outcome.exit_code, 6);
        EXPECT_THAT(outcome.err, HasSubstr("'whole.exr' is a whole image"));
        EXPECT_THAT(outcome.err, HasSubstr("'crop.exr' is the crop 64,0,64,64 of an image"));
    }
    EXPECT_EQ(run({"compare", "whole.exr", "whole.exr"}).exit_code, 0);
}

TEST_F(Compare, ImagesAtDifferentPlacesOfTheirFramesAreRefused) {
    Image image = make_gray(side, side, std::vector<float>(side * side, 1));
    write_image(image, at("first.exr"));
    image.origin = PixelPlace{0, 64};
    write_image(image, at("second.exr"));
    const Outcome outcome = run({"compare", "first.exr", "second.exr"});
    EXPECT_EQ(outcome.exit_code, 6);
    EXPECT_THAT(outcome.err, HasSubstr("'first.exr' is at pixel (0, 0) of its frame, and 'second.exr' is at pixel "
                                       "(0, 64) of its frame"));
    EXPECT_EQ(run({"compare", "second.exr", "second.exr"}).exit_code, 0);
    write_png(image, at("picture.png")); // whose format has no places
    EXPECT_EQ(run({"compare", "second.exr", "picture.png"}).exit_code, 0);
    image.channels.push_back({"albedo.R", image.channels[0].values});
    write_image(image, at("layered.exr"));
    image.origin = PixelPlace{};
    write_image(image, at("reference.exr"));
    EXPECT_EQ(run({"compare", "layered.exr", "reference.exr", "--layer", "albedo"}).exit_code, 6);
    // Ours begin at (0, 0) wherever the crop is, and those of other programs there or where it is.
    image.origin = {};
    image.metadata["crop"] = "0,64,64,64";
    write_image(image, at("crop.exr"));
    EXPECT_EQ(run({"compare", "crop.exr", "first.exr"}).exit_code, 0);
    EXPECT_EQ(run({"compare", "crop.exr", "second.exr"}).exit_code, 0);
    image.metadata["crop"] = "64,0,64,64";
    write_image(image, at("crop.exr"));
    EXPECT_EQ(run({"compare", "crop.exr", "second.exr"}).exit_code, 6);
    EXPECT_EQ(run({"compare", "second.exr", "crop.exr"}).exit_code, 6);
}

/// Of 64 x 64 values with normal errors; 3 standard errors of a share of so many are 0.022.
TEST_F(Compare, SaysHowRightAnErrorLayerIs) {
    write_noise("image.exr", 1, 0.1, 0, "64");
    write_image(make_gray(side, side, std::vector<float>(side * side, 1)), at("reference.exr"));
    const auto compare = [&](float error, std::vector<std::string> more) {
        Image image = read_image(at("image.exr"));
        for (const char *color : {"R", "G", "B"})
            image.channels.push_back({std::string("error.") + color, std::vector<float>(side * side, error)});
        image.metadata["estimated_error"] = "0.0125";
        write_image(image, at("layered.exr"));
        more.insert(more.begin(), {"compare", "layered.exr", "reference.exr", "--json", "out.json"});
        const std::string text = run(more).out + run({"compare", "layered.exr", "reference.exr"}).out;
        EXPECT_THAT(text, HasSubstr("error layer: "));
        return nlohmann::json::parse(text_of("out.json")).at("images").at(0).at("error_layer");
    };
    const nlohmann::json right = compare(0.1f, {});
    EXPECT_NEAR(right.at("within").get<double>(), 0.683, 0.022);
    EXPECT_NEAR(right.at("within_twice").get<double>(), 0.954, 0.022);
    EXPECT_EQ(right.at("relative_mse"), 0.0125);
    EXPECT_NEAR(compare(0.05f, {}).at("within_twice").get<double>(), 0.683, 0.022);
    // A reference's own error counts beside the image's.
    write_image(make_gray(side, side, std::vector<float>(side * side, 0.0064f)), at("variance.exr"));
    EXPECT_NEAR(compare(0.06f, {"--variance", "variance.exr"}).at("within").get<double>(), 0.683, 0.022);
    EXPECT_THAT(run({"compare", "image.exr", "reference.exr"}).out, ::testing::Not(HasSubstr("error layer")));
    // Other programs' images say no estimate.
    Image unstated = read_image(at("layered.exr"));
    unstated.metadata.erase("estimated_error");
    write_image(unstated, at("unstated.exr"));
    const std::string text = run({"compare", "unstated.exr", "reference.exr", "--json", "out.json"}).out;
    EXPECT_THAT(text, ::testing::AllOf(HasSubstr("error layer: "), ::testing::Not(HasSubstr("estimated"))));
    EXPECT_FALSE(
        nlohmann::json::parse(text_of("out.json")).at("images").at(0).at("error_layer").contains("relative_mse"));
}

TEST_F(Compare, PrintsFiguresOfOneImage) {
    write_image(make_gray(2, 1, {1.5f, 2}), at("image.exr"));
    write_image(make_gray(2, 1, {1, 2}), at("reference.exr"));
    const Outcome text = run({"compare", "image.exr", "reference.exr"});
    EXPECT_EQ(text.exit_code, 0) << text.err;
    EXPECT_THAT(text.out, HasSubstr("relMSE 1.2488e-01"));
    EXPECT_THAT(text.out, HasSubstr("mean ratio 1.166667"));
    const nlohmann::json json =
        nlohmann::json::parse(run({"compare", "image.exr", "reference.exr", "--json", "-"}).out);
    EXPECT_NEAR(json.at("images").at(0).at("relative_mse").get<double>(), 0.25 / 1.001 / 2, 1e-9);
    EXPECT_NEAR(json.at("images").at(0).at("psnr").get<double>(), 10 * std::log10(4 / 0.125), 1e-9);
    EXPECT_EQ(run({"compare", "image.exr", "reference.exr", "--check", "--max-relmse", "0.1"}).exit_code, 1);
    EXPECT_EQ(run({"compare", "image.exr", "reference.exr", "--check", "--max-relmse", "0.2"}).exit_code, 0);
}

/// Of what is equal it is infinite, and of what is all wrong beside black; a NaN it is where nothing can be told.
TEST_F(Compare, AnInfinitePsnrKeepsItsSign) {
    write_image(make_gray(2, 1, {1, 2}), at("image.exr"));
    write_image(make_gray(2, 1, {0, 0}), at("black.exr"));
    const auto psnr_beside = [&](const char *reference) {
        const nlohmann::json json = nlohmann::json::parse(run({"compare", "image.exr", reference, "--json", "-"}).out);
        return json.at("images").at(0).at("psnr");
    };
    EXPECT_EQ(psnr_beside("image.exr"), "inf");
    EXPECT_EQ(psnr_beside("black.exr"), "-inf");
}

TEST_F(Compare, UnbiasedSeedsHold) {
    write_set(0);
    const Outcome outcome =
        run(all({"--variance", "variance.exr", "--reference-spp", "6400", "--check", "--json", "out.json"}));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("verdict: equal within the noise"));
    const nlohmann::json json = nlohmann::json::parse(text_of("out.json"));
    EXPECT_EQ(json.at("holds"), true);
    EXPECT_EQ(json.at("samples_per_pixel"), 64);
    EXPECT_EQ(json.at("z").at("blocks").at("tested"), 48);
    EXPECT_NEAR(json.at("z").at("pixels").at("expected_over_three").get<double>(), 0.0027 * 3 * 64 * 64, 0.1);
    EXPECT_NEAR(json.at("reference_relative_mse").get<double>(), 1.0 / 6400, 0.01 / 6400);
    // Without a variance the seeds alone tell the noise.
    EXPECT_EQ(run(all({"--check"})).exit_code, 0);
    // One image is enough where the reference's variance and the counts are known.
    EXPECT_EQ(run({"compare", "seed1.exr", "reference.exr", "--variance", "variance.exr", "--reference-spp", "6400",
                   "--check"})
                  .exit_code,
              0);
}

TEST_F(Compare, AVarianceMayBeALayerOfTheReference) {
    write_image(make_gray(1, 1, {3}), at("image.exr"));
    Image reference = make_gray(1, 1, {2});
    for (const char *channel : {"variance.R", "variance.G", "variance.B"})
        reference.channels.push_back({channel, {0.5f}});
    write_image(reference, at("reference.exr"));
    const Outcome outcome = run({"compare", "image.exr", "reference.exr", "--variance", "reference.exr"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("its own relMSE 1.2497e-01"));
}

TEST_F(Compare, AVarianceOfSamplesIsNoneOfAReconstruction) {
    write_image(make_gray(1, 1, {3}), at("image.exr"));
    Image reference = make_gray(1, 1, {2});
    for (const char *channel : {"variance.R", "variance.G", "variance.B"})
        reference.channels.push_back({channel, {0.5f}});
    const auto outcome_by = [&](const char *reconstruction) {
        reference.metadata["reconstruction"] = reconstruction;
        write_image(reference, at("reference.exr"));
        return run({"compare", "image.exr", "reference.exr", "--variance", "reference.exr"});
    };
    const Outcome outcome = outcome_by("weighted");
    EXPECT_EQ(outcome.exit_code, 6);
    EXPECT_THAT(outcome.err, HasSubstr("reference.exr: its pixels are a reconstruction (weighted)"));
    EXPECT_EQ(outcome_by("none").exit_code, 0);
}

TEST_F(Compare, AVarianceBelowZeroIsRefused) {
    write_set(0.05f); // not equal
    std::vector<float> values(side * side, 1.0f / 6400);
    values[side] = -1;
    write_image(make_gray(side, side, values), at("variance.exr"));
    const Outcome outcome = run(all({"--variance", "variance.exr", "--reference-spp", "6400", "--check"}));
    EXPECT_EQ(outcome.exit_code, int(ExitCode::image));
    EXPECT_THAT(outcome.err, HasSubstr("variance.exr: a variance is below 0 in channel R: -1"));
}

TEST_F(Compare, AnErrorInOneBlockFails) {
    write_set(0.05f);
    const std::vector<std::string> checked = all({"--variance", "variance.exr", "--reference-spp", "6400", "--check"});
    const Outcome outcome = run(checked);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.out, HasSubstr("FAILED: blocks: largest |z|"));
    std::vector<std::string> unchecked = checked;
    unchecked.pop_back();
    EXPECT_EQ(run(unchecked).exit_code, 0) << "only --check gives the exit code";
}

TEST_F(Compare, TheSameSeedTwiceFails) {
    write_set(0);
    const Outcome outcome = run({"compare", "seed1.exr", "seed1.exr", "reference.exr", "--check"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.out, HasSubstr("the same seed 1"));
    // Nor is a reference of that seed another sample. relMSE alone may be measured against it.
    const Outcome reference = run({"compare", "seed1.exr", "seed1.exr", "--variance", "variance.exr", "--check"});
    EXPECT_EQ(reference.exit_code, 1);
    EXPECT_THAT(reference.out, HasSubstr("the same seed 1"));
    EXPECT_EQ(run({"compare", "seed1.exr", "seed1.exr", "--max-relmse", "1", "--check"}).exit_code, 0);
}

TEST_F(Compare, ACheckNeedsSomethingToJudgeBy) {
    write_image(make_gray(2, 1, {1, 2}), at("image.exr"));
    const Outcome outcome = run({"compare", "image.exr", "image.exr", "--check"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("nothing to judge by: give several seeds"));
    EXPECT_EQ(run({"compare", "image.exr", "image.exr"}).exit_code, 0);
    const nlohmann::json json = nlohmann::json::parse(run({"compare", "image.exr", "image.exr", "--json", "-"}).out);
    EXPECT_EQ(json.at("judged"), false);
    EXPECT_EQ(json.at("holds"), false) << "as --check says";
    EXPECT_EQ(run({"compare", "image.exr", "image.exr", "--check", "--max-relmse", "1"}).exit_code, 0);
    // What differs beyond doubt needs no measure.
    write_image(make_gray(2, 1, {1, std::numeric_limits<float>::infinity()}), at("infinite.exr"));
    EXPECT_EQ(run({"compare", "infinite.exr", "image.exr", "--check"}).exit_code, 1);
}

TEST_F(Compare, OutputsOverInputsAreRefused) {
    write_image(make_gray(2, 1, {1, 2}), at("image.exr"));
    const std::string before = text_of("image.exr");
    for (const char *option : {"--error-image", "--json"})
        for (const char *name : {"image.exr", "./image.exr"}) {
            EXPECT_EQ(run({"compare", "image.exr", "image.exr", option, name}).exit_code, 2) << option;
            EXPECT_EQ(text_of("image.exr"), before);
        }
    EXPECT_EQ(run({"compare", "image.exr", "image.exr", "--json", "a.exr", "--error-image", "./a.exr"}).exit_code, 2);
}

TEST_F(Compare, NonFiniteValuesAreReportedAndFail) {
    write_image(make_gray(2, 1, {1, std::numeric_limits<float>::quiet_NaN()}), at("image.exr"));
    write_image(make_gray(2, 1, {1, 1}), at("reference.exr"));
    const Outcome outcome = run({"compare", "image.exr", "reference.exr", "--check"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.out, HasSubstr("3 values are NaN or infinite"));
}

TEST_F(Compare, ErrorImages) {
    write_image(make_gray(2, 1, {2, 1}), at("image.exr"));
    write_image(make_gray(2, 1, {1, 1}), at("reference.exr"));
    ASSERT_EQ(run({"compare", "image.exr", "reference.exr", "--error-image", "error.png"}).exit_code, 0);
    const Image picture = read_image(at("error.png"));
    EXPECT_NEAR(picture.find("R")->values[0], 1, 1e-5);
    EXPECT_NEAR(picture.find("G")->values[0], 0, 1e-3);
    EXPECT_NEAR(picture.find("G")->values[1], 1, 1e-5);
    ASSERT_EQ(run({"compare", "image.exr", "reference.exr", "--error-image", "error.exr"}).exit_code, 0);
    EXPECT_NEAR(read_image(at("error.exr")).find("R")->values[0], 1 / std::sqrt(1.001), 1e-6);
    EXPECT_EQ(run({"compare", "image.exr", "reference.exr", "--error-image", "error.jpg"}).exit_code, 2);
}

TEST_F(Compare, ImagesThatDoNotFitAreImageErrors) {
    write_image(make_gray(2, 1, {2, 1}), at("image.exr"));
    write_image(make_gray(1, 2, {2, 1}), at("turned.exr"));
    EXPECT_EQ(run({"compare", "image.exr", "turned.exr"}).exit_code, 6);
    EXPECT_EQ(run({"compare", "image.exr", "none.exr"}).exit_code, 6);
    EXPECT_EQ(run({"compare", "image.exr", "image.exr", "--layer", "albedo"}).exit_code, 6);
    EXPECT_EQ(run({"compare", "image.exr"}).exit_code, 2);
}

TEST_F(Compare, Layers) {
    write_image(make_image(1, 1, {{"R", {1}}, {"G", {1}}, {"B", {1}}, {"albedo.R", {2}}}), at("image.exr"));
    write_image(make_image(1, 1, {{"R", {9}}, {"G", {9}}, {"B", {9}}, {"albedo.R", {1}}}), at("reference.exr"));
    const Outcome outcome = run({"compare", "image.exr", "reference.exr", "--layer", "albedo"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.out, HasSubstr("mean ratio 2.000000"));
}

} // namespace
} // namespace gradus
