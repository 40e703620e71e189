// The reconstruction of gradient-domain path tracing keeps the light: L2 is unbiased, L1 keeps local means.
#include "tests/methods/gradient_bias.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/gradient_layers.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"
#include "tests/support/stability.h"
#include "tests/support/test_name.h"
#include "tests/support/worse.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace gradus::testing {
namespace {

constexpr std::size_t mean_seeds = 16;

/// At a fixed alpha the reconstruction is linear in samples that are unbiased; at one from their variances it is not.
TEST(GradientMean, OfL2IsUnbiased) {
    Scene scene = own_scene("cornell-box.xml", 40, 40);
    scene.settings.samples_per_pixel = 16;
    std::vector<std::vector<double>> truths;
    for (const Image &image : render_seeds(scene, mean_seeds, {}, 1 + mean_seeds, "pt"))
        truths.push_back(values_of(image));
    scene.settings.samples_per_pixel = 4;
    for (const bool fixed : {true, false}) {
        RenderOptions options;
        options.reconstruction = Reconstruction::l2;
        if (fixed)
            options.alpha = 0.2;
        std::vector<std::vector<double>> estimates;
        for (const Image &image : render_seeds(scene, mean_seeds, options, 1, "gpt"))
            estimates.push_back(values_of(image));
        const BiasEstimate bias = estimate_bias(estimates, truths);
        std::printf("L2, alpha %s: squared bias %.1f standard errors, relative bias at most %.2g\n",
                    fixed ? "0.2" : "from variances", bias.squared / bias.standard_error, bias.at_most());
        if (fixed) {
            EXPECT_TRUE(bias.is_none());
        }
        record_stability(
            {"Reconstruction", "a biased estimate of an unbiased one",
             fixed ? "L2 at alpha 0.2, 16 seeds of 4 samples" : "L2 at alpha from the variances, 16 seeds of 4 samples",
             fixed ? "unbiased" : "hardly biased", "bias at most", bias.at_most(), 0.02});
    }
}

/// The place of a sample in the pixel is the same for all pixels, and so is that in the lens.
TEST(GradientMean, OfAFilterWithNegativeLobesAndALens) {
    Scene scene = own_scene("cornell-box.xml", 32, 32);
    scene.camera.kind = Camera::Kind::thin_lens;
    scene.camera.aperture_radius = 0.2;
    scene.camera.focus_distance = 3.5;
    scene.film.filter = FilmSettings::Filter::mitchell;
    scene.film.filter_radius = 2;
    const GradientBias bias = gradient_bias(scene, {.seeds = 16, .gradient_domain = 32, .path_tracing = 64});
    std::printf("bias of the primal at most %.2g, of differences %.2g\n", bias.primal.at_most(),
                bias.differences.at_most());
    EXPECT_TRUE(bias.primal.is_none()) << bias.primal.squared << ", standard error " << bias.primal.standard_error;
    EXPECT_TRUE(bias.differences.is_none())
        << bias.differences.squared << ", standard error " << bias.differences.standard_error;
}

/// Weights that all pixels share are a factor of the whole image, unless they sum up to 1: with importance sampling of
/// the filter's magnitude the brightness of a plain wall was anything between half and twice what it is, in single
/// renders of few samples, where the mean of many was right.
TEST(GradientStability, OfTheBrightnessWithNegativeLobes) {
    SceneMaker maker(24, 1);
    maker.parallelogram({-20, -20, 1}, {0, 40, 0}, {40, 0, 0}, maker.material(two_sided(diffuse(0.5))));
    maker.environment(1);
    maker.look({0, 0, -3}, {0, 0, 1}, 40);
    maker.scene.settings.max_depth = 2;
    const double expected = spread_of(render(maker.scene, {}, "gpt").image).mean; // about 0.5, by the box filter
    double off = 0;
    for (const auto &[filter, radius] :
         {std::pair{FilmSettings::Filter::lanczos, 3.0f}, std::pair{FilmSettings::Filter::mitchell, 2.0f}})
        for (const std::uint64_t samples : {1, 4, 6, 16})
            for (const bool aov : {false, true})
                for (std::uint64_t seed = 1; seed <= 3; ++seed) {
                    maker.scene.film.filter = filter;
                    maker.scene.film.filter_radius = radius;
                    maker.scene.settings.samples_per_pixel = samples;
                    RenderOptions options;
                    options.seed = seed;
                    options.aov = aov; // whose samples are four sequences
                    const double mean = spread_of(render(maker.scene, options, "gpt").image).mean;
                    off = worse(off, std::fabs(mean / expected - 1));
                }
    record_stability({"Gradients", "weights of negative lobes that all pixels share: a factor of the whole image",
                      "a wall under an even sky, Lanczos' and Mitchell's filters, 1 to 16 samples, 3 seeds",
                      "a sample serves all pixels that the filter reaches, by weights whose sum is 1",
                      "relative error of a render's brightness", off, 0.05});
}

/// Blocks of 32 x 32 pixels: L1 prefers medians, and noise is skewed. The mean correction makes up for it
/// (solver/mean_correction.h). Held against the same samples' primal, whose expectation is right: both share their
/// noise, so their difference shows the bias soonest.
void expect_mean_of_blocks(const char *name) {
    constexpr std::size_t side = 3, values = 3 * side * side;
    constexpr double count = 8;
    Scene scene = own_scene(fmt::format("{}.xml", name), 32 * side, 32 * side);
    scene.settings.samples_per_pixel = 16;
    std::vector<double> primal(values, 0.0), sum(values, 0.0), squares(values, 0.0);
    for (std::uint64_t seed = 1; seed <= std::uint64_t(count); ++seed) {
        RenderOptions options;
        options.seed = seed;
        options.reconstruction = Reconstruction::l1;
        const Image image = render(scene, options, "gpt").image, plain = whole(image);
        std::vector<double> change(values, 0.0);
        for (int c = 0; c < 3; ++c)
            for (std::uint32_t y = 0; y < image.height; ++y)
                for (std::uint32_t x = 0; x < image.width; ++x) {
                    const std::size_t block = (c * side + y / 32) * side + x / 32;
                    primal[block] += layer(plain, "", c, x, y) / count;
                    change[block] += layer(image, "", c, x, y) - layer(plain, "", c, x, y);
                }
        for (std::size_t block = 0; block < values; ++block) {
            sum[block] += change[block];
            squares[block] += change[block] * change[block];
        }
    }
    double worst = 0, noise = 0, total = 0, all = 0;
    for (std::size_t block = 0; block < values; ++block) {
        const double mean = sum[block] / count;
        const double error = std::sqrt(std::max(squares[block] / count - mean * mean, 0.0) / (count - 1));
        worst = worse(worst, (std::fabs(mean) - 2 * error) / primal[block]);
        noise = std::max(noise, error / primal[block]);
        total += mean;
        all += primal[block];
    }
    std::printf("%s: a block's mean is off by at most %.2f %%, less two standard errors (each at most %.2f %%); the "
                "image's by %.3f %%\n",
                name, 100 * worst, 100 * noise, 100 * std::fabs(total / all));
    record_stability({"Reconstruction", "L1 loses light where noise is skewed",
                      fmt::format("scenes/{}.xml, 8 seeds of 16 samples", name), "keeps local means by a correction",
                      "deviation of the mean of a block of 32 x 32, less two standard errors", worst, 0.01});
    record_stability({"Reconstruction", "L1 loses light where noise is skewed",
                      fmt::format("scenes/{}.xml, 8 seeds of 16 samples", name), "keeps the mean of the image",
                      "deviation of the mean of the image", std::fabs(total / all), 0.002});
}

class GradientMeanOf : public ::testing::TestWithParam<const char *> {};
class FullGradientMeanOf : public ::testing::TestWithParam<const char *> {};
TEST_P(GradientMeanOf, L1BlocksIsThePrimals) { expect_mean_of_blocks(GetParam()); }
TEST_P(FullGradientMeanOf, L1BlocksIsThePrimals) { expect_mean_of_blocks(GetParam()); }
INSTANTIATE_TEST_SUITE_P(Scenes, GradientMeanOf, ::testing::Values("torus-rough-glass"), name_of_scene);
INSTANTIATE_TEST_SUITE_P(Full, FullGradientMeanOf, ::testing::Values("cornell-box", "door-ajar", "plates"),
                         name_of_scene);

} // namespace
} // namespace gradus::testing
