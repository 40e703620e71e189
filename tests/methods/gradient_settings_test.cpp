// Gradient-domain path tracing as scenes and command lines ask for it: other filters, a part of the film, Russian
// roulette, few samples, a render that does not know how many there will be. All are held against another renderer.
#include "tests/methods/gradient_reference.h"
#include "tests/support/gradient_layers.h"
#include "tests/support/stability.h"

#include <fmt/format.h>

#include <functional>
#include <string>

namespace gradus::testing {
namespace {

constexpr const char *agree_with_it = "primal and differences agree with another renderer's reference, block by block";
constexpr std::size_t settings_seeds = 8;

struct Setting {
    std::string name, reference, failure, provoked_by;
    std::function<void(Scene &)> set = [](Scene &) {};
};

void PrintTo(const Setting &setting, std::ostream *out) { *out << setting.name; }

class GradientSettings : public ::testing::TestWithParam<Setting> {};

/// Away from the film's border, where Mitsuba's filter sees no samples; with the lamp.
TEST_P(GradientSettings, AgreeWithTheReference) {
    constexpr std::uint64_t samples = 8;
    ReferenceScene reference = own_reference(GetParam().reference);
    const std::uint32_t side = reference.mean.width / 2;
    crop(reference, side / 2, 4, side, side + 4);
    reference.name += "-" + GetParam().name;
    reference.block = 8;
    Scene scene = reference.scene;
    scene.settings.samples_per_pixel = samples;
    GetParam().set(scene);
    const std::vector<Image> images = render_seeds(scene, settings_seeds, {}, 1, "gpt");
    const double score = expect_gradients(reference, images, double(samples));
    noise_left_by_reconstruction(reference, images);
    record_stability({"Gradients", GetParam().failure, GetParam().provoked_by, agree_with_it,
                      "largest score of a block of 8 x 8 pixels over its limit", score, 1});
}

INSTANTIATE_TEST_SUITE_P(
    CornellBox, GradientSettings,
    ::testing::Values(Setting{"gaussian", "cornell-box-gaussian",
                              "filters wider than a pixel: base and offset path are at places in other pixels",
                              "a part of scenes/cornell-box.xml, a Gaussian filter"},
                      Setting{"tent", "cornell-box-tent",
                              "filters wider than a pixel: base and offset path are at places in other pixels",
                              "a part of scenes/cornell-box.xml, a tent filter"},
                      Setting{"crop", "cornell-box", "a part of the film: neighbours beyond it are not rendered",
                              "a part of scenes/cornell-box.xml"},
                      Setting{"roulette", "cornell-box",
                              "Russian roulette: base paths that end take their offset paths along",
                              "a part of scenes/cornell-box.xml, roulette from the first bounce on",
                              [](Scene &scene) { scene.settings.rr_depth = 1; }}),
    [](const auto &info) { return info.param.name; });

/// As `--time` renders: for samples without an end, until it is stopped in the midst.
TEST(GradientsUntilATime, AreThoseOfTheSamplesThatThereWere) {
    constexpr std::uint64_t samples = 8;
    ReferenceScene reference = own_reference("cornell-box");
    crop(reference, 32, 4, 64, 68);
    reference.name += "-until-a-time";
    reference.block = 8;
    Scene scene = reference.scene;
    scene.settings.samples_per_pixel = std::uint64_t(1) << 30;
    std::vector<Image> images;
    for (std::uint64_t seed = 1; seed <= settings_seeds; ++seed) {
        RenderOptions options;
        options.seed = seed;
        options.layers = true;
        const std::unique_ptr<Method> method = make_method("gpt", shared_device(), scene, options);
        const std::uint64_t end = samples * 64 * 68;
        method->pause_at(end);
        while (method->done_samples() < end)
            ASSERT_TRUE(method->render_batch());
        images.push_back(method->last_image());
    }
    const double score = expect_gradients(reference, images, double(samples));
    noise_left_by_reconstruction(reference, images);
    record_stability({"Gradients",
                      "a render that ends by the clock: what is decided beforehand by the number of samples",
                      "a part of scenes/cornell-box.xml, 8 of 2^30 samples", agree_with_it,
                      "largest score of a block of 8 x 8 pixels over its limit", score, 1});
}

class GradientsOfFewSamples : public ::testing::TestWithParam<int> {};

/// Weights are from variances, of which few samples tell little or nothing.
TEST_P(GradientsOfFewSamples, AreRight) {
    ReferenceScene reference = own_reference("cornell-box");
    crop(reference, 32, 4, 64, 68);
    reference.name += fmt::format("-{}-samples", GetParam());
    reference.block = 8;
    Scene scene = reference.scene;
    scene.settings.samples_per_pixel = std::uint64_t(GetParam());
    const std::vector<Image> images = render_seeds(scene, settings_seeds, {}, 1, "gpt");
    expect_gradients(reference, images, GetParam());
    record_stability({"Gradients", "few samples, whose variances say little or nothing",
                      fmt::format("a part of scenes/cornell-box.xml, samples a pixel: {}", GetParam()),
                      "gains from the first sample on, and keeps the mean",
                      "relMSE of the reconstruction over the primal's", noise_left_by_reconstruction(reference, images),
                      1.1});
}

INSTANTIATE_TEST_SUITE_P(Samples, GradientsOfFewSamples, ::testing::Values(1, 2, 4));

} // namespace
} // namespace gradus::testing
