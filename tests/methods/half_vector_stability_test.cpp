// Gradient-domain path tracing where half vectors are copied: mirrors, glass, nearly smooth surfaces and what is at
// their limits, each in a small scene, rendered without bias. In every scene some things hide behind the camera, so
// that all of them need the same kernels.
#include "tests/methods/gradient_bias.h"
#include "tests/support/small_scenes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace gradus::testing {
namespace {

constexpr const char *area = "Half-vector copy";
constexpr const char *unbiased = "copies the half vector, or fails both ways; primal and differences are unbiased";

/// A room open to the camera, at z = -3, with a lamp under its ceiling and a wall of two greys at z = 1.
SceneMaker room() {
    SceneMaker scene = scene_for_bias(7);
    const std::uint32_t white = scene.material(two_sided(diffuse(0.7))), dark = scene.material(two_sided(diffuse(0.2)));
    scene.parallelogram({-1, -1, 1}, {0, 2, 0}, {1, 0, 0}, white);
    scene.parallelogram({0, -1, 1}, {0, 2, 0}, {1, 0, 0}, dark);
    scene.floor(-1, 1, 1, white, -1);
    scene.parallelogram({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, white);
    scene.lamp({0, 0.99f, 0}, 1.6f, 1.6f, 3, white);
    hide_all_kinds(scene);
    scene.look({0.1, 0.05, -3}, {0, 0, 0}, 36);
    return scene;
}

GradientRow row(const std::string &failure, const std::string &provoked_by, double limit, double offset_limit = 0.025) {
    return {area, failure, provoked_by, unbiased, limit, offset_limit};
}

// Two mirrors that face each other show the wall and the lamp after one to four reflections.
TEST(FullHalfVectorStability, InAChainOfMirrors) {
    SceneMaker scene = room();
    const std::uint32_t polished = scene.material(two_sided(mirror()));
    scene.parallelogram({-0.5f, -0.9f, 0.6f}, {0.2f, 1.8f, 0}, {0.9f, 0, -0.3f}, polished);
    scene.parallelogram({-0.2f, -0.9f, -0.8f}, {0, 0.7f, 0.1f}, {0.7f, 0, 0.2f}, polished);
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 128}),
                   row("chains of Dirac vertices: a path that leaves the chain elsewhere has no partner",
                       "two mirrors that face each other", 0.15));
}

// A ball and a block of glass: refraction, total reflection inside, silhouettes.
TEST(HalfVectorStability, ThroughClearGlass) {
    SceneMaker scene = room();
    const std::uint32_t clear = scene.material(glass(1.5));
    scene.sphere({-0.35f, -0.2f, 0}, 0.4f, clear);
    const Vector3 corner{0.2f, -0.9f, -0.2f};
    const float side = 0.6f;
    // Outward: u x v.
    scene.parallelogram(corner, {0, side, 0}, {side, 0, 0}, clear);
    scene.parallelogram({corner.x, corner.y, corner.z + side}, {side, 0, 0}, {0, side, 0}, clear);
    scene.parallelogram(corner, {0, 0, side}, {0, side, 0}, clear);
    scene.parallelogram({corner.x + side, corner.y, corner.z}, {0, side, 0}, {0, 0, side}, clear);
    scene.parallelogram({corner.x, corner.y + side, corner.z}, {0, 0, side}, {side, 0, 0}, clear);
    scene.parallelogram(corner, {side, 0, 0}, {0, 0, side}, clear);
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 64}),
                   row("total internal reflection on one side only, silhouettes: the offset path has another event",
                       "a ball and a block of clear glass", 0.3));
}

// Twelve faces of glass behind each other, all of which a path passes, or is mirrored between.
TEST(FullHalfVectorStability, DeepInGlass) {
    SceneMaker scene = room();
    scene.scene.settings.max_depth = 20;
    const std::uint32_t clear = scene.material(glass(1.5));
    for (int i = 0; i < 12; ++i) {
        const Vector3 corner{-0.7f, -0.7f, -0.6f + 0.1f * float(i)}, up{0.1f, 1.4f, 0}, right{1.4f, 0, 0};
        // Outward: u x v.
        if (i % 2 == 0)
            scene.parallelogram(corner, up, right, clear);
        else
            scene.parallelogram(corner, right, up, clear);
    }
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 64}),
                   row("deep glass: long chains, each event of which the offset path must repeat",
                       "six panes of clear glass before a wall, paths of up to 20 edges", 0.3));
}

// A pane of glass between camera and wall, and a metal ball before it.
void expect_no_bias_at_roughness(double alpha) {
    SceneMaker scene = room();
    const std::uint32_t pane = scene.material(rough_glass(alpha, 1.5));
    const std::uint32_t metal = scene.material(rough_metal(alpha));
    scene.parallelogram({-0.9f, -0.8f, 0.3f}, {0, 1.5f, 0.1f}, {1.2f, 0, 0}, pane);
    scene.parallelogram({-0.9f, -0.8f, 0.4f}, {1.2f, 0, 0}, {0, 1.5f, 0.1f}, pane);
    scene.sphere({0.5f, -0.3f, -0.2f}, 0.4f, metal);
    expect_no_bias(
        gradient_bias(scene.scene, {8, 32, 64}),
        row("roughness 1e-4 to 1: densities over many orders of magnitude, transmitted half vectors near the "
            "surface",
            fmt::format("a pane and a metal ball of roughness {}", alpha), 0.3, 0.022));
}

class HalfVectorStabilityAtRoughness : public ::testing::TestWithParam<double> {};
class FullHalfVectorStabilityAtRoughness : public ::testing::TestWithParam<double> {};

TEST_P(HalfVectorStabilityAtRoughness, OfGlassAndMetal) { expect_no_bias_at_roughness(GetParam()); }
TEST_P(FullHalfVectorStabilityAtRoughness, OfGlassAndMetal) { expect_no_bias_at_roughness(GetParam()); }

INSTANTIATE_TEST_SUITE_P(Shifts, HalfVectorStabilityAtRoughness, ::testing::Values(1e-3, 0.1));
INSTANTIATE_TEST_SUITE_P(Full, FullHalfVectorStabilityAtRoughness, ::testing::Values(1e-4, 0.02, 0.5, 1.0));

// Polished floors seen along their plane.
TEST(HalfVectorStability, AtGrazingIncidence) {
    SceneMaker scene = room();
    scene.floor(-1, 0, 1, scene.material(two_sided(mirror())), -0.3f);
    scene.floor(0, 1, 1, scene.material(two_sided(rough_metal(0.02))), -0.3f);
    scene.look({0.05, -0.24, -3}, {0, -0.25, 1}, 12);
    expect_no_bias(gradient_bias(scene.scene, {8, 32, 256}),
                   row("grazing incidence: the Jacobian's cosines go to 0",
                       "floors of mirror and of polished metal, seen at two degrees", 0.17));
}

// Glass that is hardly there.
TEST(HalfVectorStability, AtIndexRatiosNearOne) {
    SceneMaker scene = room();
    int i = 0;
    for (const double ior : {1.0, 1.0001, 1.001, 1.02}) {
        scene.sphere({0.42f * float(i % 2) - 0.2f, 0.42f * float(i / 2) - 0.2f, 0}, 0.2f, scene.material(glass(ior)));
        ++i;
    }
    scene.sphere({0.65f, 0, 0}, 0.2f, scene.material(rough_glass(0.02, 1.001)));
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 32}),
                   row("an index ratio near 1: refraction has no half vector",
                       "balls of smooth glass, index 1 to 1.02, and one of nearly smooth", 0.15));
}

// Lamps of metal: light is found there, and light goes on from there.
TEST(FullHalfVectorStability, ToLampsThatMirror) {
    SceneMaker scene = room();
    const std::int32_t light = scene.emitter(Emitter::Kind::area, {1, 0.5f, 0.2f});
    scene.sphere({-0.4f, -0.4f, 0}, 0.35f, scene.material(mirror()), light);
    scene.sphere({0.4f, -0.4f, 0}, 0.35f, scene.material(rough_metal(0.02)), light);
    expect_no_bias(gradient_bias(scene.scene, {8, 48, 192}),
                   row("a vertex that emits and mirrors: a path that ends there reconnects, one that goes on does not",
                       "balls of mirror and of polished metal that shine", 0.15, 0.0175));
}

} // namespace
} // namespace gradus::testing
