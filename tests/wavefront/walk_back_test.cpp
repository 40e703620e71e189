// Walks over chains of the project's scenes: what arrives comes back to the chain that it came from.
#include "runtime/io/load_scene.h"
#include "tests/support/worse.h"
#include "tests/wavefront/walk_fixture.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gradus {
namespace {

using testing::worse;

using namespace lib_float;
using testing::ChainEnd;
using testing::Point;
using testing::WalkChain;
using testing::Walker;
using testing::WalkResult;

Point along(const Point &a, double t, const Point &b) { return {a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]}; }
double distance(const Point &a, const Point &b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

/// Chains from the camera, whose ends are to move by up to a fiftieth of their last segments: some pixels.
std::vector<WalkChain> from_the_camera(Walker &walker, const Scene &scene, std::mt19937_64 &random, std::size_t count) {
    const std::array<double, 16> &m = scene.camera.to_world.m;
    const double spread = std::tan(scene.camera.fov / 2 * M_PI / 180);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const auto column = [&](int c) { return Point{m[std::size_t(c)], m[std::size_t(4 + c)], m[std::size_t(8 + c)]}; };
    std::vector<WalkChain> chains;
    while (chains.size() < count) {
        const Point direction =
            along(along(column(2), spread * uniform(-1, 1), column(0)), spread * uniform(-1, 1), column(1));
        std::optional<WalkChain> chain =
            walker.sampler.sample({column(3), {}, 0}, direction, walker.walk.settings().most_vertices, 0.1, random);
        if (!chain)
            continue;
        const double segment = distance(chain->vertices.back().position, chain->end.position);
        std::normal_distribution<double> normal;
        Point aside = {normal(random), normal(random), normal(random)};
        const Point &n = chain->end.normal;
        aside = along(aside, -(aside[0] * n[0] + aside[1] * n[1] + aside[2] * n[2]), n);
        chain->target.position =
            along(chain->end.position, uniform(0, 0.02) * segment / distance(aside, {0, 0, 0}), aside);
        chains.push_back(*chain);
    }
    return chains;
}

/// All that arrive come back; returns the share that arrives.
double share_that_comes_back(const char *name, std::size_t chains_of_a_scene) {
    const Scene scene = load_scene(std::string(GRADUS_SCENES "/") + name).scene;
    constexpr std::size_t batch = 1 << 15;
    // The walk back is the walk of the chain turned around, bit for bit: of what came back once, all comes back again.
    WalkSettings once;
    once.comes_back = false;
    Walker there(scene, batch), back(scene, batch, once);
    std::mt19937_64 random(1);
    std::size_t count = 0, arrived = 0, lost = 0, elsewhere = 0, not_finite = 0;
    double farthest = 0;
    while (count < chains_of_a_scene) {
        const std::vector<WalkChain> chains =
            from_the_camera(there, scene, random, std::min(batch, chains_of_a_scene - count));
        const std::vector<WalkResult> results = there.run(chains);
        std::vector<WalkChain> turned, from;
        for (std::size_t i = 0; i < chains.size(); ++i) {
            if (results[i].outcome != walk_arrived)
                continue;
            not_finite += !std::isfinite(results[i].spread) || !std::isfinite(results[i].base_spread) ||
                          !std::isfinite(results[i].turn) || !(results[i].spread > 0);
            turned.push_back({chains[i].start, chains[i].target, chains[i].end, results[i].vertices});
            from.push_back(chains[i]);
        }
        const std::vector<WalkResult> returned = back.run(turned);
        for (std::size_t i = 0; i < turned.size(); ++i) {
            // The last segment of the way back is that of the base path, which exists.
            if (returned[i].outcome != walk_arrived) {
                lost += returned[i].outcome != walk_hidden;
                continue;
            }
            double off = 0;
            for (std::size_t k = 0; k < from[i].vertices.size(); ++k)
                off = worse(off, distance(returned[i].vertices[k].position, from[i].vertices[k].position));
            const double first = distance(from[i].vertices[0].position, from[i].start.position);
            const double off_first = distance(returned[i].vertices[0].position, from[i].vertices[0].position);
            elsewhere += off_first > 1.001 * there.walk.settings().back_tolerance * first;
            farthest = worse(farthest, off / first);
        }
        count += chains.size();
        arrived += turned.size();
    }
    const auto &counts = there.walk.counts();
    std::string text;
    for (const auto &[outcome, number] : counts)
        text += outcome == "steps" || number == 0 ? "" : " " + outcome + " " + std::to_string(number);
    std::printf(
        "  %s: %zu chains, %.2f steps, %.2f million there and back a second;%s; a vertex came back off by %.1e at "
        "most\n",
        name, count, double(counts.at("steps")) / double(counts.at("arrived")), 1e-6 * double(count) / there.seconds,
        text.c_str(), farthest);
    EXPECT_EQ(lost, 0u) << "walks whose way back does not arrive";
    EXPECT_EQ(elsewhere, 0u) << "walks whose way back ends elsewhere";
    EXPECT_EQ(not_finite, 0u);
    return double(arrived) / double(count);
}

// The survey's code has 82 % of its walks arrive, with the same number of steps.
TEST(ManifoldWalkBack, InTheTorusOfRoughGlass) {
    EXPECT_GT(share_that_comes_back("torus-rough-glass.xml", 20000), 0.8);
}
TEST(ManifoldWalkBack, InMaterials) { EXPECT_GT(share_that_comes_back("materials.xml", 20000), 0.8); }

TEST(FullManifoldWalkBack, InTheTorusOfRoughGlass) {
    EXPECT_GT(share_that_comes_back("torus-rough-glass.xml", 1000000), 0.8);
}
TEST(FullManifoldWalkBack, InMaterials) { EXPECT_GT(share_that_comes_back("materials.xml", 1000000), 0.8); }

} // namespace
} // namespace gradus
