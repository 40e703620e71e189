// The tree by which light samples choose among many lights: built by the host, walked by kernels/lib/light_tree.h.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

// After these, which have template parameters of the names of its macros.
#include "kernels/lib/light_tree.h"
#include "kernels/lib/random.h"
#include "runtime/scene/light_tree.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

namespace gradus {
namespace {

using namespace lib_float;

struct ChosenLights {
    LightTree tree;
    std::size_t near = 0, far = 0;
    double share = 0; ///< of lights at infinity

    light_receiver receiver(const Double3 &p, const Double3 &n) const {
        return light_receiver_at(v3(float(p[0]), float(p[1]), float(p[2])),
                                 light_normal_bits(v3(float(n[0]), float(n[1]), float(n[2]))), 0, tree.origin[0],
                                 tree.origin[1], tree.origin[2], tree.scale);
    }
    /// With which probability a light is chosen, as kernels have it.
    double probability(std::size_t light, const light_receiver &at) const {
        const bool is_far = light >= near;
        const float path = light_tree_path(tree.nodes.data(), tree.levels, 1, tree.leaf[light], at);
        return double(path) * tree.probability[light] * (is_far ? share : 1 - share);
    }
    light_picked pick(const light_receiver &at, float a, float b) const {
        return light_tree_pick(tree.nodes.data(), tree.leaves.data(), tree.slots.data(), tree.levels, 1, float(share),
                               at, a, b);
    }
};

class Maker {
  public:
    explicit Maker(unsigned seed) : engine_(seed) {}
    double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
    Double3 direction() {
        std::normal_distribution<double> normal;
        return normalize({normal(engine_), normal(engine_), normal(engine_)});
    }
    /// Small lamps of powers that differ by a factor of a million, some of which shine all around.
    std::vector<TreeLight> lamps(std::size_t count, double extent = 10) {
        std::vector<TreeLight> lights;
        for (std::uint32_t i = 0; i < count; ++i) {
            const Double3 p{uniform(-extent, extent), uniform(0, 0.3 * extent), uniform(-extent, extent)};
            const double size = i % 5 == 0 ? 0 : 0.02 * extent * uniform(0, 1);
            TreeLight light{p, add(p, {size, size, size / 3}), {}, std::numbers::pi, 0, i};
            light.intensity = std::exp(uniform(-7, 7));
            if (i % 3 != 0) {
                light.axis = direction();
                light.half_angle = i % 3 == 1 ? 0 : uniform(0, 1.5);
            }
            lights.push_back(light);
        }
        return lights;
    }

  private:
    std::mt19937 engine_;
};

constexpr double scene_extent = 20;

ChosenLights chosen(const std::vector<TreeLight> &lights, std::size_t far = 0) {
    ChosenLights result;
    result.near = lights.size();
    result.far = far;
    result.share = far > 0 ? 0.3 : 0;
    std::vector<std::uint32_t> numbers;
    std::vector<double> weights;
    for (std::size_t i = 0; i < far; ++i) {
        numbers.push_back(std::uint32_t(lights.size() + i));
        weights.push_back(double(i + 1));
    }
    result.tree = make_light_tree(lights, numbers, weights, std::uint32_t(lights.size() + far), scene_extent);
    return result;
}

/// Places far away, among the lights and within them, with any normals.
std::vector<light_receiver> receivers(const ChosenLights &c, const std::vector<TreeLight> &lights, Maker &maker) {
    std::vector<light_receiver> result;
    for (int i = 0; i < 12; ++i) {
        const double extent = i < 4 ? 10 : i < 6 ? 3000 : 0.01;
        Double3 p{maker.uniform(-extent, extent), maker.uniform(-extent, extent), maker.uniform(-extent, extent)};
        if (i >= 6)
            p = add(p, lights[lights.size() * std::size_t(i) / 13].low);
        result.push_back(c.receiver(p, maker.direction()));
    }
    return result;
}

class LightTreeOf : public ::testing::TestWithParam<std::size_t> {};

TEST_P(LightTreeOf, ProbabilitiesAddUpToOne) {
    Maker maker(7);
    const std::vector<TreeLight> lights = maker.lamps(GetParam());
    for (const std::size_t far : {0u, 3u}) {
        const ChosenLights c = chosen(lights, far);
        double least = 1;
        for (const light_receiver &at : receivers(c, lights, maker)) {
            double sum = 0;
            for (std::size_t i = 0; i < lights.size() + far; ++i) {
                const double p = c.probability(i, at);
                least = std::min(least, p);
                sum += p;
            }
            EXPECT_NEAR(sum, 1, 3e-6) << far; // rounding of some levels, each a few units of 2^-24
        }
        // From everywhere every light, or what it sends there would be lost.
        EXPECT_GT(least, 0);
    }
}
INSTANTIATE_TEST_SUITE_P(Lights, LightTreeOf, ::testing::Values(1, 2, 3, 4, 5, 17, 100, 1000, 5000));

// What is drawn is what is said: chi-square, corrected for nothing as one in 10^6 fails by chance.
TEST(LightTree, DrawsByItsProbabilities) {
    Maker maker(3);
    const std::vector<TreeLight> lights = maker.lamps(300);
    const ChosenLights c = chosen(lights, 2);
    const std::size_t count = lights.size() + 2;
    constexpr std::uint32_t draws = 40'000;
    std::uint32_t number = 0;
    for (const light_receiver &at : receivers(c, lights, maker)) {
        std::vector<double> found(count, 0);
        for (std::uint32_t i = 0; i < draws; ++i) {
            const random4 u = random_draw(i, ++number, 5);
            const light_picked picked = c.pick(at, u.a, u.b);
            ASSERT_LT(picked.light, count);
            found[picked.light] += 1;
            if (i % 16 == 0) { // a light sample counts with the probability that a hit on the light does
                const std::uint32_t leaf = c.tree.leaf[picked.light];
                const float told = light_tree_path(c.tree.nodes.data(), c.tree.levels, 1, leaf, at);
                ASSERT_NEAR(picked.path / told, 1, 1e-5);
            }
        }
        double chi_square = 0, cells = 0, rest = 0, rest_expected = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const double expected = c.probability(i, at) * draws;
            if (expected < 5) {
                rest += found[i];
                rest_expected += expected;
            } else {
                chi_square += (found[i] - expected) * (found[i] - expected) / expected;
                cells += 1;
            }
        }
        if (rest_expected > 5) {
            chi_square += (rest - rest_expected) * (rest - rest_expected) / rest_expected;
            cells += 1;
        }
        const double z = (chi_square - (cells - 1)) / std::sqrt(2 * std::max(cells - 1, 1.0));
        EXPECT_LT(z, 8) << cells << " cells"; // of few degrees of freedom the tail is long
    }
}

// The two ends of the random numbers.
TEST(LightTree, NeverDrawsNothing) {
    Maker maker(11);
    const float last = 1 - 0x1p-24f;
    for (const std::size_t count : {1u, 2u, 7u, 65u, 1000u}) {
        const std::vector<TreeLight> lights = maker.lamps(count);
        const ChosenLights c = chosen(lights);
        for (const light_receiver &at : receivers(c, lights, maker))
            for (const float a : {0.0f, 0.25f, last})
                for (const float b : {0.0f, 0.75f, last}) {
                    const light_picked picked = c.pick(at, a, b);
                    ASSERT_LT(picked.light, count);
                    EXPECT_GT(picked.path, 0);
                }
    }
}

/// A square of equal lamps that face down.
std::vector<TreeLight> ceiling(int side) {
    std::vector<TreeLight> lights;
    for (int i = 0; i < side * side; ++i) {
        const Double3 p{double(i % side), 3, double(i / side)};
        lights.push_back({p, add(p, {0.1, 0, 0.1}), {0, -1, 0}, 0, 1, std::uint32_t(i)});
    }
    return lights;
}

// Among 4096 equal lamps.
TEST(LightTree, PrefersWhatIsNearAndFaces) {
    std::vector<TreeLight> lights = ceiling(64);
    const std::size_t lamp = 20 * 64 + 37;
    lights[lamp + 1].axis = {0, 1, 0};
    const ChosenLights c = chosen(lights);
    // A tenth of a metre below a lamp, whose neighbours are ten times as far: 800 times an even share.
    EXPECT_GT(c.probability(lamp, c.receiver({37.05, 2.9, 20.05}, {0, 1, 0})), 0.2);
    // Two neighbours, from above and from below: only one faces.
    const light_receiver above = c.receiver({37.55, 3.5, 20.05}, {0, 1, 0}),
                         below = c.receiver({37.55, 2.5, 20.05}, {0, 1, 0});
    EXPECT_GT(c.probability(lamp + 1, above), 2 * c.probability(lamp, above));
    EXPECT_GT(c.probability(lamp, below), 2 * c.probability(lamp + 1, below));
    // On a wall a lamp that is beside it counts for less than one that is ahead.
    const Double3 wall{37.05, 2.9, 24.05};
    EXPECT_LT(c.probability(lamp, c.receiver(wall, {1, 0, 0})), c.probability(lamp, c.receiver(wall, {0, 0, 1})));
}

// What the estimate of each light would give alone: the tree's variance against it, over that of a choice by power.
TEST(LightTree, HasMuchLessVarianceThanPower) {
    Maker maker(5);
    std::vector<TreeLight> lights = maker.lamps(4000);
    for (TreeLight &light : lights)
        light.intensity = std::exp(maker.uniform(-1, 1));
    const ChosenLights c = chosen(lights);
    double of_tree = 0, of_power = 0, power = 0;
    for (const TreeLight &light : lights)
        power += light.intensity;
    for (int i = 0; i < 50; ++i) {
        const Double3 p{maker.uniform(-9, 9), 0, maker.uniform(-9, 9)};
        const light_receiver at = c.receiver(p, {0, 1, 0});
        double sum = 0, by_tree = 0, by_power = 0;
        for (const TreeLight &light : lights) {
            const Double3 to = subtract(scale(add(light.low, light.high), 0.5), p);
            const double squared = dot(to, to), distance = std::sqrt(squared);
            const double angle = std::acos(std::clamp(-dot(light.axis, to) / distance, -1.0, 1.0));
            const double leaving = std::cos(std::max(angle - light.half_angle, 0.0));
            const double value = light.intensity * std::max(leaving, 0.0) * std::max(to[1], 0.0) / distance / squared;
            sum += value;
            by_tree += value * value / c.probability(light.light, at);
            by_power += value * value / (light.intensity / power);
        }
        of_tree += by_tree / (sum * sum) - 1;
        of_power += by_power / (sum * sum) - 1;
    }
    std::printf("relative variance by tree %.2f, by power %.1f\n", of_tree / 50, of_power / 50);
    EXPECT_LT(of_tree, 0.04 * of_power);
}

// Nearly at the origin, too, where their coordinates are rounding: places in the scene stay in the tree's range.
TEST(LightTree, HoldsLampsThatAreAllAtOnePlace) {
    for (const Double3 &place : {Double3{1e4, 2, 3}, {0, 0, 0}, {5.5e-17, 0, 0}, {1e-8, 0, 0}}) {
        std::vector<TreeLight> lights;
        for (std::uint32_t i = 0; i < 500; ++i)
            lights.push_back({place, place, {}, std::numbers::pi, 1.0 + i, i});
        const ChosenLights c = chosen(lights);
        for (const double away : {0.0, 2.0, scene_extent}) {
            double sum = 0;
            for (std::size_t i = 0; i < lights.size(); ++i)
                sum += c.probability(i, c.receiver(add(place, {away, 0, 0}), {0, 0, 1}));
            EXPECT_NEAR(sum, 1, 3e-6) << "at " << place[0] << ", from " << away << " away";
        }
    }
}

TEST(LightTree, IsTheSameOnAnyNumberOfCores) {
    const std::vector<TreeLight> lights = Maker(9).lamps(30'000);
    LightTree trees[2];
    for (const int threads : {1, 2}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
        trees[threads - 1] = make_light_tree(lights, {}, {}, std::uint32_t(lights.size()), scene_extent);
    }
    EXPECT_EQ(trees[0].nodes, trees[1].nodes);
    EXPECT_EQ(trees[0].slots, trees[1].slots);
    EXPECT_EQ(trees[0].leaves, trees[1].leaves);
}

// A quarter of a million lights: the tree of each quarter of them takes a quarter of the time, but for a logarithm.
TEST(LightTree, OfAQuarterOfAMillionLights) {
    double seconds[2];
    LightTree tree;
    std::vector<TreeLight> lights;
    for (const int i : {0, 1}) {
        lights = Maker(2).lamps(i == 0 ? 62'500 : 250'000, 1000);
        const auto start = std::chrono::steady_clock::now();
        tree = make_light_tree(lights, {}, {}, std::uint32_t(lights.size()), scene_extent);
        seconds[i] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    std::printf("trees of 62,500 and 250,000 lights: %.2f s, %.2f s; %u levels\n", seconds[0], seconds[1], tree.levels);
    EXPECT_LT(seconds[1], 8 * seconds[0]);
    ChosenLights c;
    c.tree = tree;
    c.near = lights.size();
    const light_receiver at = c.receiver({1, 2, 3}, {0, 1, 0});
    double sum = 0;
    for (std::size_t i = 0; i < lights.size(); ++i)
        sum += c.probability(i, at);
    EXPECT_NEAR(sum, 1, 1e-5);
}

} // namespace
} // namespace gradus
