// The variances that images tell of themselves over those that images of independent seeds have.
#pragma once

#include "tests/support/gradient_layers.h"
#include "tests/support/small_scenes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

namespace gradus::testing {

constexpr std::uint32_t wall_side = 16;

/// A plain wall under a lamp that is not seen: all that is drawn is smooth, so that the samples of a sequence have a
/// fraction of the variance that their spread tells.
inline Scene smooth_wall(std::uint64_t samples) {
    SceneMaker maker(wall_side, samples);
    maker.look({0, 1.5, -3}, {0, 0, 0}, 20, {0, 0, 1});
    maker.scene.settings.max_depth = 2;
    const std::uint32_t white = maker.material(diffuse(0.5));
    maker.floor(-2, 2, 2, white);
    maker.lamp({0, 1, 1.5f}, 1, 1, 10, white);
    return maker.scene;
}

/// Told variances over the variance that images of independent seeds have, summed over pixels and channels.
struct ToldOverTrue {
    double ratio = 0, standard_error = 0; ///< of the ratio, where it is 1

    /// The images' own differences of both sums tell the standard error, whether pixels are alike or not. With 15
    /// degrees of freedom or more, chance exceeds 5.5 of them in one test of 16,000.
    double limit() const { return 5.5 * standard_error; }
};

/// `layer` and its variance: names without the colour. `outermost` are left out at the right and at the bottom, where
/// differences are none.
inline ToldOverTrue told_over_true(const std::vector<Image> &images, const std::string &layer, const std::string &told,
                                   std::uint32_t outermost = 0) {
    const double n = double(images.size());
    std::vector<double> told_sums(images.size()), true_sums(images.size());
    for (const char *color : colors) {
        const auto name = [&](const std::string &of) { return of.empty() ? color : fmt::format("{}.{}", of, color); };
        for (std::uint32_t y = 0; y + outermost < images[0].height; ++y)
            for (std::uint32_t x = 0; x + outermost < images[0].width; ++x) {
                double mean = 0;
                for (const Image &image : images)
                    mean += pixel(image, x, y, name(layer)) / n;
                for (std::size_t i = 0; i < images.size(); ++i) {
                    const double apart = pixel(images[i], x, y, name(layer)) - mean;
                    true_sums[i] += apart * apart * n / (n - 1);
                    told_sums[i] += pixel(images[i], x, y, name(told));
                }
            }
    }
    std::vector<double> differences;
    for (std::size_t i = 0; i < images.size(); ++i)
        differences.push_back(told_sums[i] - true_sums[i]);
    const double truth = spread_of(true_sums).mean;
    return {spread_of(told_sums).mean / truth, spread_of(differences).standard_error / truth};
}

/// `most`: the limit must be under it. What goes wrong with sequences is a factor of 1.7 and more (the spread of all
/// samples) or all of the variance (scrambled alike).
inline void expect_right(const ToldOverTrue &found, double most, const std::string &what) {
    std::printf("%s: variance told over true %.3f, limit %.3f\n", what.c_str(), found.ratio, found.limit());
    EXPECT_NEAR(found.ratio, 1, found.limit()) << what;
    EXPECT_LT(found.limit(), most) << what << ": nothing would be seen";
}

inline RenderOptions with_aov() {
    RenderOptions options;
    options.aov = true;
    return options;
}

} // namespace gradus::testing
