// Images that follow a guide, of gpt and of pt.
#include "runtime/film/metrics.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"

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

/// Of eight samples, against 512 of another seed, whose own error is far below. The filter takes off at least the half
/// of what weights leave, and nine tenths of what path tracing has.
TEST_P(GuidedImages, AreNearerToTheTruth) {
    const Image truth = [] {
        RenderOptions options;
        options.seed = 100;
        return render(scene_of(512), options, "pt").image;
    }();
    const Scene scene = scene_of(8);
    RenderOptions options = guided(1);
    const Rendered with = render(scene, options, GetParam());
    EXPECT_EQ(with.statistics.reconstruction.name, "guided");
    EXPECT_EQ(with.statistics.reconstruction.guide, "filter");
    EXPECT_EQ(with.statistics.reconstruction.accuracy, "consistent");
    options.reconstruction = Reconstruction::weighted;
    const Image without = render(scene, options, GetParam()).image;
    const double share = std::string(GetParam()) == "pt" ? 0.2 : 0.8;
    EXPECT_LT(relative_mse(with.image, truth), share * relative_mse(without, truth));
    const MeanComparison means = compare_means(with.image, truth);
    EXPECT_NEAR(means.ratio, 1, 0.01);
}

TEST_P(GuidedImages, OfOneSampleSayThatTheyAreNone) {
    const Scene scene = scene_of(1);
    const Rendered result = render(scene, guided(), GetParam());
    EXPECT_NE(result.statistics.reconstruction.name, "guided");
    EXPECT_THAT(result.statistics.reconstruction.note, ::testing::HasSubstr("guided needs"));
    EXPECT_EQ(count_non_finite(result.image), 0u);
}

INSTANTIATE_TEST_SUITE_P(Methods, GuidedImages, ::testing::Values("gpt", "pt"),
                         [](const auto &info) { return std::string(info.param); });

} // namespace
} // namespace gradus::testing
