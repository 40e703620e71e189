// The light that the camera sees at pixels which a lamp's edge crosses.
#include "runtime/methods/direct_light.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"

#include <gtest/gtest.h>

namespace gradus::testing {
namespace {

/// A lamp whose borders lie at these places of a film of 16 x 16 pixels, seen at a right angle.
Scene lamp(double left, double top, double right, double bottom) {
    SceneMaker maker(16, 16);
    maker.look({0, 0, -1}, {0, 0, 0}, 90); // a pixel is 1 / 8 wide at z = 0
    const std::int32_t light = maker.emitter(Emitter::Kind::area, {10, 20, 40});
    const auto at = [](double pixels) { return float((pixels - 8) / 8); };
    const auto width = float((right - left) / 8), height = float((bottom - top) / 8);
    // Seen from -z with y upwards, x points to the left.
    maker.parallelogram({-at(right), -at(bottom), 0}, {0, height, 0}, {width, 0, 0}, maker.material(diffuse(0.5)),
                        light);
    maker.scene.settings.max_depth = 1;
    return maker.scene;
}

double covered(double low, double high, double pixel) {
    return std::max(0.0, std::min(high, pixel + 1) - std::max(low, pixel));
}

TEST(DirectLight, IsTheShareOfThePixelThatTheLampCovers) {
    const double left = 3.3, top = 5.009, right = 11.85, bottom = 9.5;
    const Image image = render(lamp(left, top, right, bottom), {}, "gpt").image;
    double worst = 0;
    for (std::uint32_t y = 0; y < 16; ++y)
        for (std::uint32_t x = 0; x < 16; ++x) {
            const double share = covered(left, right, x) * covered(top, bottom, y);
            worst = std::max(worst, std::fabs(pixel(image, x, y, "direct.G") / 20 - share));
            EXPECT_EQ(pixel(image, x, y, "primal.G"), 0);
        }
    std::printf("largest error of a pixel, of what it would be if covered: %.4f\n", worst);
    EXPECT_LT(worst, 0.02);
}

TEST(DirectLight, IsUnbiasedOverSeeds) {
    const Scene scene = lamp(3.3, 5.009, 11.85, 9.5);
    constexpr int seeds = 64;
    double sum = 0, squares = 0;
    for (const Image &image : render_seeds(scene, seeds, {}, 1, "gpt")) {
        const double value = pixel(image, 3, 5, "direct.R") / 10;
        sum += value;
        squares += value * value;
    }
    const double mean = sum / seeds, error = std::sqrt(std::max(squares / seeds - mean * mean, 1e-12) / (seeds - 1));
    EXPECT_NEAR(mean, 0.7 * 0.991, 4 * error);
    EXPECT_LT(error, 0.001);
}

} // namespace
} // namespace gradus::testing
