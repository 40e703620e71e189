// The reconstruction of gradient-domain path tracing keeps the light: L2 is unbiased, L1 keeps local means.
#include "tests/methods/gradient_bias.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/gradient_layers.h"
#include "tests/support/stability.h"
#include "tests/support/test_name.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace gradus::testing {
namespace {

constexpr std::size_t seeds = 64;

/// At a fixed alpha the reconstruction is linear in samples that are unbiased; at one from their variances it is not.
TEST(GradientMean, OfL2IsUnbiased) {
    Scene scene = own_scene("cornell-box.xml", 48, 48);
    for (const bool fixed : {true, false}) {
        RenderOptions options;
        options.norm = PoissonNorm::l2;
        if (fixed)
            options.alpha = 0.2;
        scene.settings.samples_per_pixel = 4;
        const std::vector<Image> reconstructed = render_seeds(scene, seeds, options, 1, "gpt");
        scene.settings.samples_per_pixel = 64;
        const std::vector<Image> path_traced = render_seeds(scene, seeds, {}, 1 + seeds, "pt");
        std::vector<std::vector<double>> estimates, truths;
        for (std::size_t i = 0; i < seeds; ++i) {
            estimates.push_back(values_of(reconstructed[i]));
            truths.push_back(values_of(path_traced[i]));
        }
        const BiasEstimate bias = estimate_bias(estimates, truths);
        std::printf("L2, alpha %s: squared bias %.1f standard errors, relative bias at most %.2g\n",
                    fixed ? "0.2" : "from variances", bias.squared / bias.standard_error, bias.at_most());
        if (fixed) {
            EXPECT_TRUE(bias.is_none());
        }
        record_stability(
            {"Reconstruction", "a biased estimate of an unbiased one",
             fixed ? "L2 at alpha 0.2, 64 seeds of 4 samples" : "L2 at alpha from the variances, 64 seeds of 4 samples",
             fixed ? "unbiased" : "hardly biased", "bias at most", bias.at_most(), 0.02});
    }
}

/// A scene, and how much of a block's light may be lost.
class GradientMeanOf : public ::testing::TestWithParam<std::pair<const char *, double>> {};

/// Blocks of 32 x 32 pixels, means over seeds: L1 prefers medians, and noise is skewed. The mean correction makes up
/// for it (solver/mean_correction.h).
TEST_P(GradientMeanOf, L1BlocksIsThePrimals) {
    const auto [name, limit] = GetParam();
    Scene scene = own_scene(std::string(name) + ".xml", 96, 96);
    scene.settings.samples_per_pixel = 16;
    std::vector<double> primal(9 * 3, 0.0), ours(9 * 3, 0.0);
    for (const Image &image : render_seeds(scene, 8, {}, 1, "gpt")) {
        const Image plain = whole(image);
        for (int c = 0; c < 3; ++c)
            for (std::uint32_t y = 0; y < 96; ++y)
                for (std::uint32_t x = 0; x < 96; ++x) {
                    const std::size_t block = std::size_t(c) * 9 + y / 32 * 3 + x / 32;
                    primal[block] += layer(plain, "", c, x, y);
                    ours[block] += layer(image, "", c, x, y);
                }
    }
    double worst = 0;
    for (std::size_t block = 0; block < primal.size(); ++block)
        worst = std::max(worst, std::fabs(ours[block] / primal[block] - 1));
    std::printf("%s: largest deviation of a block's mean from the primal's: %.2f %%\n", name, 100 * worst);
    record_stability(
        {"Reconstruction", "L1 loses light where noise is skewed",
         std::string("scenes/") + name + ".xml, 8 seeds of 16 samples",
         "keeps local means by a correction, but for what a few samples of a block carry alone: they would "
         "spread over all of it",
         "deviation of the mean of a block of 32 x 32", worst, limit});
}

INSTANTIATE_TEST_SUITE_P(Scenes, GradientMeanOf,
                         ::testing::Values(std::pair{"cornell-box", 0.01}, std::pair{"plates", 0.01},
                                           // Most of its light comes in rare samples.
                                           std::pair{"door-ajar", 0.06}),
                         [](const auto &info) { return test_name(info.param.first); });

} // namespace
} // namespace gradus::testing
