// Images that follow a guide, of gpt and of pt.
#include "runtime/film/metrics.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/stability.h"
#include "tests/support/test_name.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace gradus::testing {
namespace {

class GuidedImages : public ::testing::TestWithParam<const char *> {
  protected:
    static Scene scene_of(std::uint64_t samples) {
        Scene scene = own_scene("cornell-box.xml", 81, 61);
        scene.settings.samples_per_pixel = samples;
        return scene;
    }
    static RenderOptions guided(std::uint64_t seed = 0) {
        RenderOptions options;
        options.seed = seed;
        options.reconstruction = Reconstruction::guided;
        return options;
    }
};

/// Frames of 4941 pixels end within batches, and halves with them.
TEST_P(GuidedImages, DoNotDependOnTheBatchSize) {
    const Scene scene = scene_of(5);
    const Image image = render(scene, guided(), GetParam()).image;
    for (const std::uint32_t batch_size : {1000u, 5000u}) {
        RenderOptions options = guided();
        options.batch_size = batch_size;
        EXPECT_TRUE(equal_bits(image, render(scene, options, GetParam()).image)) << "batch size " << batch_size;
    }
}

TEST_P(GuidedImages, KeepFeaturesForThemselves) {
    const Scene scene = scene_of(4);
    RenderOptions options = guided();
    const std::unique_ptr<Method> method = make_method(GetParam(), shared_device(), scene, options);
    while (method->render_batch()) { // without layers, of which features are some
    }
    const Image image = method->image();
    for (const Channel &channel : image.channels)
        EXPECT_THAT(channel.name, ::testing::Not(::testing::ContainsRegex("albedo|normal|depth|^variance")));
    options.aov = true;
    options.variance = false; // for which samples are drawn otherwise
    const Image with_features = render(scene, options, GetParam()).image;
    EXPECT_TRUE(with_features.find("albedo.R") && with_features.find("depth.Z"));
    for (const char *name : {"R", "G", "B"})
        EXPECT_EQ(image.find(name)->values, with_features.find(name)->values);
}

/// Of eight samples and of few. The filter takes off at least a fifth of what weights leave, and four fifths of what
/// path tracing has; of few samples, of which each half has one or two, something.
TEST_P(GuidedImages, AreNearerToTheTruth) {
    ReferenceScene reference = own_reference("cornell-box");
    const bool is_pt = std::string(GetParam()) == "pt";
    const int few = is_pt ? 2 : 4; // the least that are guided
    for (const int samples : {8, few}) {
        reference.scene.settings.samples_per_pixel = std::uint64_t(samples);
        RenderOptions options = guided(1);
        const Rendered with = render(reference.scene, options, GetParam());
        EXPECT_EQ(with.statistics.reconstruction.name, "guided");
        EXPECT_EQ(with.statistics.reconstruction.guide, "filter");
        EXPECT_EQ(with.statistics.reconstruction.accuracy, "consistent");
        options.reconstruction = Reconstruction::weighted;
        const Image without = render(reference.scene, options, GetParam()).image;
        const double left = relative_mse(with.image, reference.mean) / relative_mse(without, reference.mean);
        EXPECT_NEAR(compare_means(with.image, reference.mean).ratio, 1, samples == 8 ? 0.01 : 0.03);
        record_stability({"Reconstruction", "few samples to a guided image: its halves are one or two each",
                          fmt::format("scenes/cornell-box.xml, {}, samples a pixel: {}", GetParam(), samples),
                          "each half judges the other's guide; nearer to another renderer's reference",
                          "relMSE over that of weights alone", left,
                          samples == 2 ? 1
                          : is_pt      ? 0.2
                                       : 0.8});
    }
}

TEST_P(GuidedImages, OfOneSampleSayThatTheyAreNone) {
    const Scene scene = scene_of(1);
    const Rendered result = render(scene, guided(), GetParam());
    EXPECT_NE(result.statistics.reconstruction.name, "guided");
    EXPECT_THAT(result.statistics.reconstruction.note, ::testing::HasSubstr("guided needs"));
    record_stability({"Reconstruction", "one sample to a guided image: there are no halves",
                      fmt::format("scenes/cornell-box.xml, {}, one sample a pixel", GetParam()),
                      "says how many it needs and takes another reconstruction", "values that are not finite",
                      double(count_non_finite(result.image)), 0});
}

TEST_P(GuidedImages, OfLightWithoutSquaresSaySo) {
    for (const float factor : {1.0f, 1e-17f, 1e21f}) {
        Scene scene = scene_of(4);
        for (Emitter &emitter : scene.emitters)
            for (float Rgb::*channel : {&Rgb::r, &Rgb::g, &Rgb::b})
                emitter.value.*channel *= factor;
        for (const Reconstruction reconstruction : {Reconstruction::guided, Reconstruction::weighted}) {
            RenderOptions options;
            options.reconstruction = reconstruction;
            const std::string note = render(scene, options, GetParam()).statistics.reconstruction.note;
            const bool is_reconstructed = reconstruction == Reconstruction::guided || GetParam() == std::string("gpt");
            EXPECT_EQ(note.find("make the lights brighter or darker") != std::string::npos,
                      factor != 1 && is_reconstructed)
                << factor << ": " << note;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, GuidedImages, ::testing::Values("gpt", "pt"), name_of_method);

} // namespace
} // namespace gradus::testing
