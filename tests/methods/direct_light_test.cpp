// The light that the camera sees at pixels which a lamp's edge crosses.
#include "runtime/direct_light/direct_light.h"
#include "runtime/direct_light/lit_rectangle.h"
#include "runtime/direct_light/shared_rays.h"
#include "runtime/film/metrics.h"
#include "runtime/scene/filter_table.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"
#include "tests/support/worse.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

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
            worst = worse(worst, std::fabs(pixel(image, x, y, "direct.G") / 20 - share));
            EXPECT_EQ(pixel(image, x, y, "primal.G"), 0);
        }
    std::printf("largest error of a pixel, of what it would be if covered: %.4f\n", worst);
    EXPECT_LT(worst, 0.01); // the 16 samples of the image alone are off by 0.04 and more
}

/// Rays of a pixel serve those around it: each shows the filter's integral over the lamp.
TEST(DirectEdges, AreWhatTheFilterHasOfTheLamp) {
    const double left = 33.3, top = 45.009, right = 61.85, bottom = 59.5;
    for (const auto &[filter, radius] : {std::pair{FilmSettings::Filter::gaussian, 2.0f},
                                         {FilmSettings::Filter::mitchell, 2.0f},
                                         {FilmSettings::Filter::tent, 1.0f}}) {
        Scene scene = lamp(left, top, right, bottom);
        scene.film.filter = filter;
        scene.film.filter_radius = radius;
        // By the midpoint rule; the lamp's borders lie on steps, nearly.
        constexpr int steps = 4000;
        double whole = 0;
        for (int i = 0; i < steps; ++i)
            whole += filter_value(scene.film, ((i + 0.5) / steps * 2 - 1) * radius);
        const auto share = [&, radius = radius](double low, double high, double pixel) {
            double sum = 0;
            for (int i = 0; i < steps; ++i) {
                const double x = ((i + 0.5) / steps * 2 - 1) * radius, at = pixel + 0.5 + x;
                sum += at >= low && at < high ? filter_value(scene.film, x) / whole : 0;
            }
            return sum;
        };
        std::vector<double> across, down;
        for (std::uint32_t i = 0; i < size; ++i) {
            across.push_back(share(left, right, i));
            down.push_back(share(top, bottom, i));
        }
        const Rendered rendered = render(scene, {}, "gpt");
        double worst = 0;
        for (std::uint32_t y = 0; y < size; ++y)
            for (std::uint32_t x = 0; x < size; ++x)
                worst = worse(worst, std::fabs(pixel(rendered.image, x, y, "direct.G") / 20 - across[x] * down[y]));
        std::printf("largest error of a pixel, of what it would be if covered: %.4f\n", worst);
        EXPECT_LT(worst, 0.025) << int(filter);
        EXPECT_GT(rendered.statistics.rays.at("edge"), 100'000u);
    }
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

/// Beyond some hundred rays a pixel the error is not seen, and time is: one ray a sample would be four million.
TEST(DirectEdges, TakeNoMoreRaysThanTheyNeed) {
    Scene scene = lamp(33.3, 45.009, 61.85, 59.5);
    scene.film.width = scene.film.height = 4 * size;
    const std::uint64_t rays = render(scene, {}, "gpt").statistics.rays.at("edge");
    const std::uint64_t lit = 115 * 59, border = 119 * 63 - 109 * 53; // pixels that an edge is in or beside
    std::printf("%llu rays\n", static_cast<unsigned long long>(rays));
    EXPECT_GT(rays, 300 * border / 2);
    EXPECT_LE(rays, 4 * lit + (256 + 32 * 16) * border);
}

TEST(SharedRays, GoByNeedWithinBounds) {
    using ::testing::ElementsAre;
    EXPECT_THAT(shared_rays({1, 3, 2}, 60, 1, 100), ElementsAre(10, 30, 20));
    EXPECT_THAT(shared_rays({1, 3, 2}, 60, 1, 24), ElementsAre(12, 24, 24)) << "what is too much goes to others";
    EXPECT_THAT(shared_rays({1, 3, 2}, 60, 11, 100), ElementsAre(0, 36, 24)) << "and so does what is too little";
    EXPECT_THAT(shared_rays({1, 3, 2}, 600, 11, 100), ElementsAre(100, 100, 100));
    EXPECT_THAT(shared_rays({1, 3, 2}, 10, 11, 100), ElementsAre(0, 0, 0));
    EXPECT_THAT(shared_rays({2, 2, 2, 2}, 43, 20, 100), ElementsAre(21, 21, 0, 0)) << "the first of equals";
    EXPECT_THAT(shared_rays({}, 43, 20, 100), ElementsAre());
}

/// Lamps and a filter so wide that a border is near every pixel, and rays are few for all of them.
TEST(DirectEdges, AreSampledThoughTheyAreMany) {
    constexpr std::uint32_t side = 32;
    SceneMaker maker(side, 64);
    maker.look({0, 0, -1}, {0, 0, 0}, 90);
    const std::uint32_t black = maker.material(diffuse(0));
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            maker.parallelogram({-0.72f + 0.57f * float(i), -0.74f + 0.55f * float(j), 0}, {0, 0.13f, 0}, {0.13f, 0, 0},
                                black, maker.emitter(Emitter::Kind::area, {10, 20, 40}));
    maker.scene.film.filter = FilmSettings::Filter::gaussian;
    maker.scene.film.filter_radius = 2;
    maker.scene.settings.max_depth = 1;
    Scene many = maker.scene;
    many.settings.samples_per_pixel = 16384;
    const Image truth = render(many, {}, "pt").image;
    const auto relative_error = [&](const char *method) {
        double sum = 0;
        for (const Image &image : render_seeds(maker.scene, 8, {}, 1, method))
            sum += relative_mse(image, truth) / 8;
        return sum;
    };
    const double paths = relative_error("pt"), edges = relative_error("gpt");
    std::printf("relMSE of lamps seen: %.3g, of paths alone %.3g\n", edges, paths);
    EXPECT_LT(edges, 0.75 * paths);
}

PixelRectangle rectangle_of(const Scene &scene) {
    FilmSettings film = scene.film;
    if (film.crop_width == 0) {
        film.crop_width = film.width;
        film.crop_height = film.height;
    }
    return lit_rectangle(make_scene_tables(scene, scene_traits(scene)), film);
}

TEST(LitRectangle, HoldsALampAndLittleMore) {
    Scene scene = lamp(33.3, 45.009, 61.85, 59.5);
    const auto expect = [&](std::uint32_t left, std::uint32_t top, std::uint32_t right, std::uint32_t bottom) {
        const PixelRectangle lit = rectangle_of(scene);
        EXPECT_THAT((std::array{lit.left, lit.top, lit.right, lit.bottom}),
                    ::testing::ElementsAre(left, top, right, bottom));
    };
    expect(32, 44, 63, 61);
    scene.film.crop_x = 40;
    scene.film.crop_y = 50;
    scene.film.crop_width = scene.film.crop_height = 20;
    expect(0, 0, 20, 11);
    scene.film.crop_x = 80;
    expect(0, 0, 0, 0);
}

/// No camera ray through another pixel may find the light: all are tried.
TEST(LitRectangle, MissesNoPixelThatSeesASphere) {
    SceneMaker maker(size, 1);
    maker.look({0, 0, -4}, {0, 0, 0}, 60);
    maker.sphere({1.1f, 0.7f, -1.5f}, 0.5f, maker.material(diffuse(0.5)),
                 maker.emitter(Emitter::Kind::area, {1, 1, 1}));
    maker.scene.settings.max_depth = 1;
    const PixelRectangle lit = rectangle_of(maker.scene);
    const Image image = render(maker.scene, {}, "gpt").image;
    std::size_t inside = 0;
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x) {
            const bool is_lit = pixel(image, x, y, "direct.G") > 0;
            EXPECT_TRUE(!is_lit || lit.contains(x, y)) << x << ", " << y;
            inside += is_lit;
        }
    EXPECT_GT(inside, 100u);
    EXPECT_LT(lit.width() * lit.height(), 3 * inside);
}

TEST(LitRectangle, IsAllWhereALightMayBeAnywhere) {
    const auto expect_all = [](const Scene &scene) {
        const PixelRectangle lit = rectangle_of(scene);
        EXPECT_EQ(lit.width(), size);
        EXPECT_EQ(lit.height(), size);
    };
    SceneMaker around(size, 1);
    around.look({0, 0, -4}, {0, 0, 0}, 60);
    around.environment(1);
    expect_all(around.scene);
    SceneMaker behind(size, 1); // the camera looks along a lamp that begins behind it
    behind.look({0, 0, 0}, {0, 0, 1}, 60);
    behind.lamp({0, 1, 0}, 1, 10, 1, behind.material(diffuse(0.5)));
    expect_all(behind.scene);
}

} // namespace
} // namespace gradus::testing
