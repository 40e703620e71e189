// The light of an environment map and the sampling of its directions, by the kernels' own functions on the host.
#include "runtime/film/distributions.h"
#include "runtime/scene/environment_map.h"
#include "tests/support/worse.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <vector>

// After TBB, which has template parameters of the names of its macros.
#define TRAIT_LIGHT_ENVIRONMENT 1
#include "kernels/lib/environment.h"

namespace gradus {
namespace {

using testing::worse;

using namespace lib_float;

constexpr double pi = 3.14159265358979323846;

struct MapImage {
    std::uint32_t width, height;
    std::vector<float> red, green, blue;
};

MapImage image_by(std::uint32_t width, std::uint32_t height,
                  const std::function<std::array<double, 3>(std::uint32_t, std::uint32_t)> &color) {
    MapImage image{width, height, {}, {}, {}};
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            const auto [r, g, b] = color(x, y);
            image.red.push_back(float(r));
            image.green.push_back(float(g));
            image.blue.push_back(float(b));
        }
    return image;
}

/// Colours of few digits, which texels hold exactly, by chance; some black, some bright.
MapImage image_by_chance(std::uint32_t width, std::uint32_t height, std::uint32_t seed) {
    std::mt19937 random(seed);
    return image_by(width, height, [&](std::uint32_t, std::uint32_t) {
        const auto number = [&] { return double(random() % 256) / 16; };
        const double factor = random() % 8 == 0 ? 0 : random() % 50 == 0 ? 256 : 1;
        return std::array<double, 3>{factor * number(), factor * number(), factor * number()};
    });
}

EnvironmentMap map_of(const MapImage &image) {
    return make_environment_map(image.width, image.height, image.red, image.green, image.blue);
}

environment_light_value look(const EnvironmentMap &map, vec3 direction) {
    return environment_lookup(direction, map.scale, 1, map.texels.data(), map.cells.data(), map.strips.data(),
                              map.columns, map.rows, std::uint32_t(map.strips.size() / 2));
}

environment_choice sample(const EnvironmentMap &map, random4 u) {
    return environment_sample(u, map.scale, 1, map.texels.data(), map.cells.data(), map.strips.data(), map.columns,
                              map.rows, std::uint32_t(map.strips.size() / 2));
}

vec3 direction_at(double around, double from_pole) {
    const double sine = std::sin(pi * from_pole);
    return v3(float(sine * std::sin(2 * pi * around)), float(std::cos(pi * from_pole)),
              float(-sine * std::cos(2 * pi * around)));
}

/// What Mitsuba 3.9's map shows in that direction: found by comparing its renderings with this formula.
std::array<double, 3> expected_at(const MapImage &image, double around, double from_pole) {
    const double x = around * image.width - 0.5, y = from_pole * std::max(image.height - 1.0, 1.0);
    const double column = std::floor(x), row = std::min(std::floor(y), std::max(image.height, 2u) - 2.0);
    const double s = x - column, t = y - row;
    std::array<double, 3> sum{};
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
            const std::size_t at_x = std::size_t(column + i + image.width) % image.width;
            const std::size_t at_y = std::min(std::size_t(row) + std::size_t(j), std::size_t(image.height) - 1);
            const std::size_t at = at_y * image.width + at_x;
            const double weight = (i ? s : 1 - s) * (j ? t : 1 - t);
            sum[0] += weight * image.red[at];
            sum[1] += weight * image.green[at];
            sum[2] += weight * image.blue[at];
        }
    return sum;
}

class EnvironmentMaps : public ::testing::TestWithParam<std::array<std::uint32_t, 2>> {
  protected:
    MapImage image_ = image_by_chance(GetParam()[0], GetParam()[1], 7);
    EnvironmentMap map_ = map_of(image_);
};

TEST_P(EnvironmentMaps, ShowWhatTheImageSaysBetweenItsTexels) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    double largest = 0;
    for (const float value : image_.red)
        largest = worse(largest, double(value));
    for (int i = 0; i < 20000; ++i) {
        const double around = uniform(random), from_pole = std::acos(1 - 2 * uniform(random)) / pi;
        const rgb seen = look(map_, direction_at(around, from_pole)).radiance;
        const auto expected = expected_at(image_, around, from_pole);
        // Angles are good to 1e-7 of a turn, and near the poles what turns about them to that over their sine.
        const double error = largest * (1e-6 + 4e-7 * image_.width / std::sin(pi * from_pole) + 4e-7 * image_.height);
        ASSERT_NEAR(seen.r * map_.unit, expected[0], error) << around << ' ' << from_pole;
        ASSERT_NEAR(seen.g * map_.unit, expected[1], error) << around << ' ' << from_pole;
        ASSERT_NEAR(seen.b * map_.unit, expected[2], error) << around << ' ' << from_pole;
    }
}

// Cells of the chart (turn, angle from the pole): the counts of samples against the density
// integrated over the cell by the midpoint rule, whose points lie evenly about the texels of the widest map.
TEST_P(EnvironmentMaps, AreSampledWithTheDensityThatIsStated) {
    constexpr std::uint32_t across = 60, down = 41, points = 24;
    constexpr std::uint64_t samples = 1'000'000;
    std::vector<double> expected(across * down, 0), found(across * down, 0);
    double whole = 0;
    for (std::uint32_t row = 0; row < down; ++row)
        for (std::uint32_t column = 0; column < across; ++column) {
            double sum = 0;
            for (std::uint32_t j = 0; j < points; ++j)
                for (std::uint32_t i = 0; i < points; ++i) {
                    const double from_pole = (row + (j + 0.5) / points) / down;
                    const double around = (column + (i + 0.5) / points) / across;
                    sum += look(map_, direction_at(around, from_pole)).pdf * std::sin(pi * from_pole);
                }
            expected[row * across + column] = sum / (points * points) * 2 * pi * pi / (across * down);
            whole += expected[row * across + column];
        }
    EXPECT_NEAR(whole, 1, 2e-3) << "the integral of the density over all directions";
    std::array<double, 3> energy{};
    for (std::uint64_t i = 0; i < samples; ++i) {
        const environment_choice chosen = sample(map_, random_draw(std::uint32_t(i), 5u, 3u));
        const vec3 d = chosen.direction;
        ASSERT_NEAR(v3_dot(d, d), 1, 1e-5);
        const double around = std::atan2(double(d.x), -double(d.z)) / (2 * pi);
        const double from_pole = std::atan2(std::hypot(double(d.x), double(d.z)), double(d.y)) / pi;
        const auto column = std::min(std::uint32_t((around - std::floor(around)) * across), across - 1);
        found[std::min(std::uint32_t(from_pole * down), down - 1) * across + column] += 1;
        ASSERT_GT(chosen.pdf, 0);
        const double weight = map_.unit / chosen.pdf / double(samples);
        energy[0] += chosen.radiance.r * weight;
        energy[1] += chosen.radiance.g * weight;
        energy[2] += chosen.radiance.b * weight;
        // The density of the sample is that which a ray in its direction is told, but for the roundings of angles.
        if (i % 64 == 0 && std::hypot(d.x, d.z) > 0.05f) {
            ASSERT_NEAR(look(map_, d).pdf / chosen.pdf, 1, 2e-2 + 1e-5 * image_.width) << i;
        }
    }
    double chi_square = 0;
    std::size_t cells = 0;
    double rest_expected = 0, rest_found = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const double mean = expected[i] / whole * double(samples);
        if (mean < 25) {
            rest_expected += mean;
            rest_found += found[i];
            continue;
        }
        chi_square += (found[i] - mean) * (found[i] - mean) / mean;
        ++cells;
    }
    if (rest_expected > 25) {
        chi_square += (rest_found - rest_expected) * (rest_found - rest_expected) / rest_expected;
        ++cells;
    }
    ASSERT_GT(cells, 2u);
    // Wilson and Hilferty's normal for chi-square; the midpoint rule's error adds to it where cells cross kinks.
    const double degrees = double(cells - 1);
    const double z = (std::cbrt(chi_square / degrees) - (1 - 2 / (9 * degrees))) / std::sqrt(2 / (9 * degrees));
    std::printf("%u x %u: chi-square %.1f of %zu cells, z %.2f\n", image_.width, image_.height, chi_square, cells, z);
    EXPECT_LT(z, 4.5);
    // What the samples say of the whole light, and what the map does: of a million samples whose weights, radiance
    // over luminance, spread by no more than twice themselves.
    const double exact[3] = {map_.integral.r, map_.integral.g, map_.integral.b};
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(energy[c] / exact[c], 1, 6 * 2 / std::sqrt(double(samples)));
}

INSTANTIATE_TEST_SUITE_P(Sizes, EnvironmentMaps,
                         ::testing::Values(std::array<std::uint32_t, 2>{1, 1}, std::array<std::uint32_t, 2>{1, 5},
                                           std::array<std::uint32_t, 2>{7, 2}, std::array<std::uint32_t, 2>{16, 9},
                                           std::array<std::uint32_t, 2>{30, 21}, std::array<std::uint32_t, 2>{360, 3}),
                         [](const auto &info) {
                             return std::to_string(info.param[0]) + "x" + std::to_string(info.param[1]);
                         });

// Half floats and RGBE have no more digits than texels keep.
TEST(EnvironmentMap, KeepsElevenBits) {
    const double values[] = {0x1p-10, 0x1.ffcp-3, 1, 0x1.554p+2, 60000, 65504, 0};
    const MapImage image = image_by(7, 2, [&](std::uint32_t x, std::uint32_t) {
        return std::array<double, 3>{values[x], values[6 - x], 0.25};
    });
    const EnvironmentMap map = map_of(image);
    for (std::uint32_t x = 0; x < 7; ++x) {
        const environment_texel texel = environment_load(map.texels.data(), x, 1, 0);
        EXPECT_NEAR(double(texel.radiance.r) * map.unit, values[x], values[x] * 1e-7) << x;
        EXPECT_NEAR(double(texel.radiance.g) * map.unit, values[6 - x], values[6 - x] * 1e-7) << x;
        EXPECT_EQ(texel.radiance.b * map.unit, 0.25f);
    }
}

TEST(EnvironmentMap, IntegralOfAConstantOne) {
    const EnvironmentMap map = map_of(image_by(12, 7, [](std::uint32_t, std::uint32_t) {
        return std::array<double, 3>{0.5, 1, 2};
    }));
    EXPECT_NEAR(map.integral.r / (4 * pi), 0.5, 1e-6);
    EXPECT_NEAR(map.integral.g / (4 * pi), 1, 1e-6);
    EXPECT_NEAR(map.integral.b / (4 * pi), 2, 1e-6);
}

// A sun of one texel, a million times its sky: light over density stays bounded wherever a sample falls, but for the
// sky's dim last part of a cell beside it.
TEST(EnvironmentMap, ASunOfOneTexelIsSampledEvenly) {
    const MapImage image = image_by(256, 129, [](std::uint32_t x, std::uint32_t y) {
        const double value = x == 40 && y == 30 ? 1e5 : 0.1;
        return std::array<double, 3>{value, value, value};
    });
    const EnvironmentMap map = map_of(image);
    double sum = 0, squares = 0, largest = 0;
    constexpr int samples = 200000;
    for (int i = 0; i < samples; ++i) {
        const environment_choice chosen = sample(map, random_draw(std::uint32_t(i), 9u, 2u));
        const double weight = double(chosen.radiance.g) * map.unit / chosen.pdf;
        sum += weight / samples;
        squares += weight * weight / samples;
        largest = worse(largest, weight);
    }
    std::printf("relative variance of a sample %.2g, largest over the mean %.3f\n", squares / (sum * sum) - 1,
                largest / sum);
    EXPECT_NEAR(sum, map.integral.g, 1e-3 * sum);
    EXPECT_LT(squares / (sum * sum) - 1, 1e-3);
    EXPECT_LT(largest / sum, 2);
}

TEST(EnvironmentMap, IsTheSameForAnyNumberOfThreads) {
    const MapImage image = image_by_chance(300, 140, 3);
    EnvironmentMap one;
    tbb::task_arena(1).execute([&] { one = map_of(image); });
    const EnvironmentMap many = map_of(image);
    EXPECT_EQ(one.texels, many.texels);
    EXPECT_EQ(one.cells, many.cells);
    EXPECT_EQ(one.strips, many.strips);
    EXPECT_EQ(one.scale, many.scale);
    EXPECT_EQ(one.integral, many.integral);
}

// Beside a light that is hardly a number black is black.
TEST(EnvironmentMap, HasBlackBesideTheLeastLightThereIs) {
    for (const double least : {1e-28, 1e-33, 1e-38, 1e-44}) {
        const EnvironmentMap map = map_of(image_by(4, 3, [&](std::uint32_t x, std::uint32_t) {
            return std::array<double, 3>{x == 1 ? least : 0, 0, 0};
        }));
        const double seen = double(environment_load(map.texels.data(), 1, 1, 0).radiance.r) * map.unit;
        EXPECT_EQ(environment_load(map.texels.data(), 3, 1, 0).radiance.r, 0) << least;
        EXPECT_NEAR(seen, least, least > 1e-35 ? 1e-3 * least : least) << least;
        EXPECT_TRUE(std::isfinite(map.integral.r)) << least;
    }
}

TEST(EnvironmentMap, ABlackOneHasNoLight) {
    const EnvironmentMap map =
        map_of(image_by(4, 3, [](std::uint32_t, std::uint32_t) { return std::array<double, 3>{}; }));
    EXPECT_EQ(map.integral, Rgb{});
    EXPECT_EQ(look(map, v3(0.6f, 0.8f, 0)).radiance.r, 0);
    EXPECT_EQ(look(map, v3(0.6f, 0.8f, 0)).pdf, 0);
}

} // namespace
} // namespace gradus
