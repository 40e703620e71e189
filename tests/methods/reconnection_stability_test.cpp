// Gradient-domain path tracing where reconnections are at their worst: for each case a small scene, rendered without
// bias. Samples and limits are such that planted defects show: a Jacobian of 1 in the crease and the corner, one
// without cosines at the lamp, Dirac vertices that merge beside mirrors.
#include "tests/methods/gradient_bias.h"
#include "tests/support/small_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace gradus::testing {
namespace {

constexpr const char *area = "Reconnection";
constexpr const char *unbiased = "reconnects; the weights keep primal and differences unbiased";

/// A floor in stripes of the materials in turn, each about three pixels wide, a wall for mirrors to show, and a lamp.
void add_striped_room(SceneMaker &scene, const std::vector<std::uint32_t> &stripes, std::uint32_t wall) {
    for (std::size_t i = 0; i < 12; ++i)
        scene.floor(0.1f * float(i) - 0.6f, 0.1f * float(i) - 0.5f, 1, stripes[i % stripes.size()]);
    scene.parallelogram({-1, 0, 1}, {0, 1, 0}, {2, 0, 0}, wall);
    scene.lamp({0, 1.5f, 0}, 1, 1, 5, scene.material(diffuse(0.5)));
    scene.look({0, 1.2, -1.5}, {0, 0, 0.2}, 35);
}

// Two walls that meet at 20 degrees. What the camera sees is 0.09 wide around the crease, where they are 0.015 apart.
TEST(ReconnectionStability, InACreaseOfTwoWalls) {
    const auto height = float(3 * std::tan(20 * std::numbers::pi / 180));
    SceneMaker scene = scene_for_bias();
    const std::uint32_t white = scene.material(two_sided(diffuse(0.8))), wall = scene.material(two_sided(diffuse(0.4)));
    scene.floor(0, 3, 3, white);
    scene.parallelogram({0, 0, -3}, {0, 0, 6}, {3, height, 0}, wall);
    const std::int32_t light = scene.emitter(Emitter::Kind::area, {5, 5, 5});
    scene.parallelogram({3, 0, -3}, {0, 0, 6}, {0, height, 0}, wall, light);
    scene.look({1, std::tan(10 * std::numbers::pi / 180), 0}, {0, 0, 0}, 5);
    expect_no_bias(gradient_bias(scene.scene, {8, 32, 128}),
                   {area, "very short edges: the distance in the Jacobian goes to 0, its square's ratio to infinity",
                    "a crease of 20 degrees, pixels a fifth of the distance between its walls", unbiased, 0.3});
}

// Three walls that meet at a right angle; the corner in the middle of the image.
TEST(ReconnectionStability, InACornerOfThreeWalls) {
    SceneMaker scene = scene_for_bias();
    scene.parallelogram({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, scene.material(two_sided(diffuse(0.8))));
    scene.parallelogram({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, scene.material(two_sided(diffuse(0.5))));
    scene.parallelogram({0, 0, 0}, {0, 2, 0}, {0, 0, 2}, scene.material(two_sided(diffuse(0.3))));
    scene.lamp({1.5f, 2, 1.5f}, 0.7f, 0.7f, 10, scene.material(diffuse(0.5)));
    scene.look({1, 1.1, 1.2}, {0, 0, 0}, 6);
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 64}),
                   {area, "corners: short edges and a change of wall from pixel to pixel",
                    "a corner of three walls in the middle of the image", unbiased, 0.15});
}

// Thin plates that stand on the floor, a few pixels apart: what one pixel reconnects to from the front, its neighbour
// sees from the back.
TEST(ReconnectionStability, ToPlatesSeenFromTheBack) {
    SceneMaker scene = scene_for_bias();
    scene.floor(-2, 2, 2, scene.material(two_sided(diffuse(0.8))));
    const std::uint32_t one_sided = scene.material(diffuse(0.9));
    for (int i = -6; i <= 6; ++i)
        scene.parallelogram({0.05f * float(i), 0, -1}, {0, 0.1f, 0}, {0, 0, 2}, one_sided);
    scene.lamp({1, 2, 0.3f}, 1, 1, 10, scene.material(diffuse(0.5)));
    scene.look({0.1, 3, 0.4}, {0, 0, 0}, 9);
    expect_no_bias(gradient_bias(scene.scene, {8, 32, 128}),
                   {area, "back-facing: the offset path would meet the second vertex from its other side",
                    "a floor with thin one-sided plates, one for three or four pixels",
                    "the shift fails for both directions alike; primal and differences are unbiased", 0.15});
}

/// A lamp lights the floor by a two-sided card alone, whose normals lean by 53 degrees: along the floor the card is
/// seen from the front, then from behind, by these, and always from the front by its own. Normals of a mesh that are
/// averaged over its edges do as much. `glow`: what the card emits.
GradientBias bias_under_a_leaning_card(float glow) {
    SceneMaker scene = scene_for_bias(3);
    scene.floor(-9, 9, 9, scene.material(diffuse(0.8)));
    const std::int32_t of_card = glow > 0 ? scene.emitter(Emitter::Kind::area, {glow, glow, glow}) : -1;
    scene.parallelogram({-2, 2, -2}, {4, 0, 0}, {0, 0, 4}, scene.material(two_sided(diffuse(0.9))), of_card);
    scene.scene.meshes.back().normals.assign(4, {-0.8f, -0.6f, 0});
    const std::int32_t light = scene.emitter(Emitter::Kind::area, {50, 50, 50});
    scene.parallelogram({-4, 0.05f, -1}, {0, 0, 2}, {1, 0, 0}, scene.material(diffuse(0)), light);
    scene.look({1, 1.8, -1.8}, {1, 0, 0}, 45);
    return gradient_bias(scene.scene, {8, 256, 2048});
}

constexpr const char *other_side = "two-sided vertices that base and offset path see from different sides by the "
                                   "shading normal: each has the vertex in a frame of its own";

TEST(FullReconnectionStability, ToTheOtherSideByShadingNormals) {
    expect_no_bias(bias_under_a_leaning_card(0),
                   {area, other_side,
                    "a floor under a wide card whose normals lean by 53 degrees, which alone sees the lamp",
                    "the shift fails for both directions alike; primal and differences are unbiased", 0.25});
}

TEST(FullReconnectionStability, ToTheOtherSideOfWhatGlows) {
    expect_no_bias(bias_under_a_leaning_card(0.3f),
                   {area, other_side, "such a card, which also glows",
                    "paths end there by its light; those that go on fail alike both ways; unbiased", 0.25});
}

// Stripes of chalk and metal, which find the lamp by quite different densities, under a lamp whose normals lean.
TEST(FullReconnectionStability, ToALampFromEitherSideByShadingNormals) {
    SceneMaker scene = scene_for_bias(2);
    const std::uint32_t stripes[] = {scene.material(diffuse(0.7)), scene.material(two_sided(rough_metal(0.1)))};
    for (int i = 0; i < 16; ++i)
        scene.floor(0.08f * float(i - 8), 0.08f * float(i - 7), 2, stripes[i % 2]);
    const std::int32_t light = scene.emitter(Emitter::Kind::area, {3, 3, 3});
    scene.parallelogram({0.447f, 0.7f, -1}, {0.16f, 0, 0}, {0, 0, 2}, scene.material(two_sided(diffuse(0.5))), light);
    scene.scene.meshes.back().normals.assign(4, {0.8f, -0.6f, 0});
    scene.look({-1.8, 2.4, 0}, {0, 0, 0}, 20);
    expect_no_bias(gradient_bias(scene.scene, {8, 512, 1024}),
                   {area, "a lamp that base and offset path see from different sides by its shading normal",
                    "stripes of chalk and metal under a lamp whose normals lean by 53 degrees",
                    "its light knows of no side: paths reconnect and end there; unbiased", 0.04});
}

// A lamp that stands on the floor: its lower border is where floor and lamp meet, and the floor behind it is dark. The
// camera looks along the lamp, which is a line to it.
TEST(ReconnectionStability, ToALightOnAnEdge) {
    SceneMaker scene = scene_for_bias();
    const std::uint32_t white = scene.material(two_sided(diffuse(0.8)));
    scene.floor(-1, 1, 1, white);
    const std::int32_t light = scene.emitter(Emitter::Kind::area, {4, 4, 4});
    scene.parallelogram({0, 0, -1}, {0, 0.2f, 0}, {0, 0, 2}, white, light);
    scene.floor(0.5f, 1, 1, white, 0.4f); // out of sight; it sends light back to the floor
    scene.look({0, 2, 0}, {0, 0, 0}, 6, {0, 0, 1});
    expect_no_bias(gradient_bias(scene.scene, {8, 32, 128}),
                   {area, "a light on an edge: distances to it go to 0 and it turns from front to back",
                    "a lamp that stands on the floor, seen along its plane", unbiased, 0.12});
}

/// A floor in stripes of the materials in turn under a sheet of rough metal that leans over it, and a lamp below the
/// floor's horizon: all of its light comes by the sheet, which both samplers leave for it. Neighbouring pixels see a
/// vertex on the sheet from quite different sides.
void add_leaning_sheet(SceneMaker &scene, const std::vector<std::uint32_t> &stripes, float width = 0.004f) {
    for (std::size_t i = 0; i < 12; ++i)
        scene.floor(width * float(i), width * float(i + 1), 0.1f, stripes[i % stripes.size()]);
    scene.parallelogram({0, 0, -0.2f}, {0.2f, 0.2f, 0}, {0, 0, 0.4f}, scene.material(two_sided(rough_metal(0.05))));
    const std::int32_t light = scene.emitter(Emitter::Kind::area, {5, 5, 5});
    scene.parallelogram({1, -0.25f, -0.125f}, {0, 0, 0.25f}, {0, 0.25f, 0}, scene.material(two_sided(diffuse(0))),
                        light);
    scene.look({1, 0.4, 0}, {0.02, 0, 0}, 2);
}

TEST(FullReconnectionStability, ToGlossyMetal) {
    SceneMaker scene = scene_for_bias(3);
    add_leaning_sheet(scene, {scene.material(diffuse(0.9)), scene.material(diffuse(0.1))});
    expect_no_bias(gradient_bias(scene.scene, {8, 1024, 2048}),
                   {area,
                    "glossy reconnection vertices: base and offset path would find a light from there with different "
                    "densities",
                    "a sheet of metal of roughness 0.05 that leans over the floor and alone sees the lamp", unbiased,
                    0.1});
}

// Every third stripe is of metal under the roughness threshold, and a stripe is a pixel: of each base path from chalk
// some offset paths reconnect, and others go on by themselves.
TEST(FullReconnectionStability, ToGlossyMetalBesideOthers) {
    SceneMaker scene = scene_for_bias(3);
    add_leaning_sheet(
        scene,
        {scene.material(diffuse(0.9)), scene.material(diffuse(0.1)), scene.material(two_sided(rough_metal(0.009)))},
        0.0031f);
    expect_no_bias(gradient_bias(scene.scene, {8, 2048, 4096}),
                   {area, "glossy reconnection vertices where some offset paths copy",
                    "such a sheet over stripes of chalk and of metal of roughness 0.009", unbiased, 0.1});
}

// Stripes of chalk and of what scatters nothing, but draws directions all the same: of its kind and of another.
TEST(ReconnectionStability, FromChalkBesideBlack) {
    SceneMaker scene = scene_for_bias(3);
    Bsdf tarnished = rough_metal(0.5);
    tarnished.specular_reflectance = {0, 0, 0};
    const std::uint32_t chalk = scene.material(diffuse(0.8));
    const std::uint32_t stripes[] = {chalk, scene.material(diffuse(0)), chalk, scene.material(tarnished)};
    for (int i = -8; i < 8; ++i)
        scene.floor(0.1f * float(i), 0.1f * float(i + 1), 1, stripes[(i + 8) % 4]);
    scene.lamp({0, 0.5f, 0}, 2, 2, 3, scene.material(diffuse(0)));
    hide_all_kinds(scene);
    scene.look({0, 0.45, -0.9}, {0, 0, 0}, 60);
    expect_no_bias(gradient_bias(scene.scene, {8, 32, 32}),
                   {area, "black beside white: the offset path is worth nothing, but its sampler finds the light",
                    "stripes of chalk, soot and black metal under a wide lamp", unbiased, 0.1});
}

// Stripes of chalk and of mirrors.
TEST(ReconnectionStability, FromChalkBesideMirrors) {
    SceneMaker scene = scene_for_bias();
    const std::uint32_t chalk = scene.material(two_sided(diffuse(0.7))), polished = scene.material(mirror());
    add_striped_room(scene, {chalk, polished}, chalk);
    hide_all_kinds(scene);
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 64}),
                   {area, "very rough next to specular: a path of densities becomes one of a Dirac lobe",
                    "a floor of chalk and mirrors in stripes of three pixels",
                    "never mixes them: the shift fails for both directions alike; unbiased", 0.3});
}

// Stripes of metal whose roughness is just under and just over 0.01, and far under it, beside chalk.
TEST(FullReconnectionStability, FromMetalAboutTheRoughnessThreshold) {
    SceneMaker scene = scene_for_bias();
    const std::uint32_t under = scene.material(rough_metal(0.0099)), over = scene.material(rough_metal(0.0101));
    const std::uint32_t chalk = scene.material(two_sided(diffuse(0.5))), far_under = scene.material(rough_metal(0.002));
    add_striped_room(scene, {under, over, chalk, far_under}, chalk);
    expect_no_bias(gradient_bias(scene.scene, {8, 32, 256}),
                   {area,
                    "glossy just over and under the roughness threshold: base and offset path would take different "
                    "shifts",
                    "a floor of metal, roughness 0.0099, 0.0101 and 0.002, and chalk, in stripes of three pixels",
                    "unbiased, whichever shift is taken", 0.3});
}

} // namespace
} // namespace gradus::testing
