// The light that the camera sees at pixels which a lamp's edge crosses.
#include "runtime/methods/direct_light.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"

#include <gtest/gtest.h>

namespace gradus::testing {
namespace {

constexpr std::uint32_t size = 128;

/// A lamp whose borders lie at these places of the film, in pixels, seen at a right angle.
Scene lamp(double left, double top, double right, double bottom) {
    SceneMaker maker(size, 16);
    maker.look({0, 0, -1}, {0, 0, 0}, 90); // the film is 2 wide at z = 0
    const std::int32_t light = maker.emitter(Emitter::Kind::area, {10, 20, 40});
    const auto at = [](double pixels) { return float(2 * pixels / size - 1); };
    const auto width = float(2 * (right - left) / size), height = float(2 * (bottom - top) / size);
    // Seen from -z with y upwards, x points to the left.
    maker.parallelogram({-at(right), -at(bottom), 0}, {0, height, 0}, {width, 0, 0}, maker.material(diffuse(0.5)),
                        light);
    maker.scene.settings.max_depth = 1;
    return maker.scene;
}

double covered(double low, double high, double pixel) {
    return std::max(0.0, std::min(high, pixel + 1) - std::max(low, pixel));
}

TEST(DirectEdges, IsTheShareOfThePixelThatTheLampCovers) {
    const double left = 33.3, top = 45.009, right = 61.85, bottom = 59.5;
    const Image image = render(lamp(left, top, right, bottom), {}, "gpt").image;
    double worst = 0;
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x) {
            const double share = covered(left, right, x) * covered(top, bottom, y);
            worst = std::max(worst, std::fabs(pixel(image, x, y, "direct.G") / 20 - share));
            EXPECT_EQ(pixel(image, x, y, "primal.G"), 0);
        }
    std::printf("largest error of a pixel, of what it would be if covered: %.4f\n", worst);
    EXPECT_LT(worst, 0.01); // the 16 samples of the image alone are off by 0.04 and more
}

TEST(DirectEdges, IsUnbiasedOverSeeds) {
    const Scene scene = lamp(33.3, 45.009, 61.85, 59.5);
    constexpr int seeds = 16;
    double sum = 0, squares = 0;
    for (const Image &image : render_seeds(scene, seeds, {}, 1, "gpt")) {
        const double value = pixel(image, 33, 45, "direct.R") / 10;
        sum += value;
        squares += value * value;
    }
    const double mean = sum / seeds, error = std::sqrt(std::max(squares / seeds - mean * mean, 1e-12) / (seeds - 1));
    EXPECT_NEAR(mean, 0.7 * 0.991, 4 * error);
    EXPECT_LT(error, 0.002);
}

} // namespace
} // namespace gradus::testing
