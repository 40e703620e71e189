// Gradient-domain path tracing where reconnections are at their worst: for each case a small scene, rendered without
// bias. Samples and limits are such that planted defects show: a Jacobian of 1 in the crease and the corner, one
// without cosines at the lamp, Dirac vertices that merge beside mirrors.
#include "tests/methods/gradient_bias.h"
#include "tests/support/small_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace gradus::testing {
namespace {

constexpr std::uint32_t size = 32;
constexpr const char *area = "Reconnection";
constexpr const char *unbiased = "reconnects; the weights keep primal and differences unbiased";

Material both_sides(double albedo) { return two_sided(diffuse(albedo), diffuse(albedo)); }

Bsdf mirror() {
    Bsdf bsdf;
    bsdf.kind = BsdfKind::conductor;
    return bsdf;
}

Bsdf glossy(double alpha) {
    Bsdf bsdf;
    bsdf.kind = BsdfKind::roughconductor;
    bsdf.distribution = Microfacet::ggx;
    bsdf.alpha_u = bsdf.alpha_v = float(alpha);
    return bsdf;
}

SceneMaker maker() {
    SceneMaker maker(size, 1);
    maker.scene.settings.max_depth = 6;
    return maker;
}

/// A lamp that shines downwards, w wide and d deep, its centre at p.
void lamp_above(SceneMaker &maker, Vector3 p, float w, float d, float radiance) {
    const std::int32_t light = maker.emitter(Emitter::Kind::area, {radiance, radiance, radiance});
    maker.parallelogram({p.x - w / 2, p.y, p.z - d / 2}, {w, 0, 0}, {0, 0, d}, maker.material(diffuse(0.5)), light);
}

/// A floor from x0 to x1, z from -extent to extent, its front upwards.
void add_floor(SceneMaker &maker, float x0, float x1, float extent, std::uint32_t material, float y = 0) {
    maker.parallelogram({x0, y, -extent}, {0, 0, 2 * extent}, {x1 - x0, 0, 0}, material);
}

// Two walls that meet at 20 degrees. What the camera sees is 0.09 wide around the crease, where they are 0.015 apart.
TEST(ReconnectionStability, InACreaseOfTwoWalls) {
    const auto height = float(3 * std::tan(20 * std::numbers::pi / 180));
    SceneMaker scene = maker();
    const std::uint32_t white = scene.material(both_sides(0.8)), wall = scene.material(both_sides(0.4));
    add_floor(scene, 0, 3, 3, white);
    scene.parallelogram({0, 0, -3}, {0, 0, 6}, {3, height, 0}, wall);
    const std::int32_t light = scene.emitter(Emitter::Kind::area, {5, 5, 5});
    scene.parallelogram({3, 0, -3}, {0, 0, 6}, {0, height, 0}, wall, light);
    scene.look({1, std::tan(10 * std::numbers::pi / 180), 0}, {0, 0, 0}, 5);
    expect_no_bias(gradient_bias(scene.scene, {8, 32, 256}),
                   {area, "very short edges: the distance in the Jacobian goes to 0, its square's ratio to infinity",
                    "a crease of 20 degrees, pixels a fifth of the distance between its walls", unbiased, 0.3});
}

// Three walls that meet at a right angle; the corner in the middle of the image.
TEST(ReconnectionStability, InACornerOfThreeWalls) {
    SceneMaker scene = maker();
    scene.parallelogram({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, scene.material(both_sides(0.8)));
    scene.parallelogram({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, scene.material(both_sides(0.5)));
    scene.parallelogram({0, 0, 0}, {0, 2, 0}, {0, 0, 2}, scene.material(both_sides(0.3)));
    lamp_above(scene, {1.5f, 2, 1.5f}, 0.7f, 0.7f, 10);
    scene.look({1, 1.1, 1.2}, {0, 0, 0}, 6);
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 256}),
                   {area, "corners: short edges and a change of wall from pixel to pixel",
                    "a corner of three walls in the middle of the image", unbiased, 0.15});
}

// Thin plates that stand on the floor, about as far apart as pixels: what one pixel reconnects to from the front, its
// neighbour sees from the back.
TEST(ReconnectionStability, ToPlatesSeenFromTheBack) {
    SceneMaker scene = maker();
    add_floor(scene, -2, 2, 2, scene.material(both_sides(0.8)));
    const std::uint32_t one_sided = scene.material(diffuse(0.9));
    for (int i = -6; i <= 6; ++i)
        scene.parallelogram({0.05f * float(i), 0, -1}, {0, 0.1f, 0}, {0, 0, 2}, one_sided);
    lamp_above(scene, {1, 2, 0.3f}, 1, 1, 10);
    scene.look({0.1, 3, 0.4}, {0, 0, 0}, 9);
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 256}),
                   {area, "back-facing: the offset path would meet the second vertex from its other side",
                    "a floor with thin one-sided plates, one for two pixels",
                    "the shift fails for both directions alike; primal and differences are unbiased", 0.15});
}

// A lamp that stands on the floor: its lower border is where floor and lamp meet, and the floor behind it is dark. The
// camera looks along the lamp, which is a line to it.
TEST(ReconnectionStability, ToALightOnAnEdge) {
    SceneMaker scene = maker();
    const std::uint32_t wall = scene.material(both_sides(0.8));
    add_floor(scene, -1, 1, 1, wall);
    const std::int32_t light = scene.emitter(Emitter::Kind::area, {4, 4, 4});
    scene.parallelogram({0, 0, -1}, {0, 0.2f, 0}, {0, 0, 2}, wall, light);
    add_floor(scene, 0.5f, 1, 1, wall, 0.4f);
    scene.look({0, 2, 0}, {0, 0, 0}, 6, {0, 0, 1});
    expect_no_bias(gradient_bias(scene.scene, {8, 96, 256}),
                   {area, "a light on an edge: distances to it go to 0 and it turns from front to back",
                    "a lamp that stands on the floor, seen along its plane", unbiased, 0.15});
}

// A floor of squares, a third of a pixel to two pixels wide as seen: mirrors and chalk in turn.
TEST(ReconnectionStability, FromChalkBesideMirrors) {
    SceneMaker scene = maker();
    const std::uint32_t chalk = scene.material(both_sides(0.7)), polished = scene.material(mirror());
    for (int i = 0; i < 12; ++i)
        add_floor(scene, 0.1f * float(i) - 0.6f, 0.1f * float(i) - 0.5f, 1, i % 2 ? polished : chalk);
    scene.parallelogram({-1, 0, 1}, {0, 1, 0}, {2, 0, 0}, chalk); // the wall that mirrors show
    lamp_above(scene, {0, 1.5f, 0}, 1, 1, 5);
    scene.look({0, 1.2, -1.5}, {0, 0, 0.2}, 35);
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 256}),
                   {area, "very rough next to specular: a path of densities becomes one of a Dirac lobe",
                    "a floor of chalk and mirrors in stripes of three pixels",
                    "never mixes them: the shift fails for both directions alike; unbiased", 0.3});
}

// Stripes of metal whose roughness is just under and just over 0.01, and far under it, beside chalk.
TEST(ReconnectionStability, FromMetalAboutTheRoughnessThreshold) {
    SceneMaker scene = maker();
    const std::uint32_t materials[] = {scene.material(glossy(0.0099)), scene.material(glossy(0.0101)),
                                       scene.material(both_sides(0.5)), scene.material(glossy(0.002))};
    for (int i = 0; i < 12; ++i)
        add_floor(scene, 0.1f * float(i) - 0.6f, 0.1f * float(i) - 0.5f, 1, materials[i % 4]);
    scene.parallelogram({-1, 0, 1}, {0, 1, 0}, {2, 0, 0}, materials[2]);
    lamp_above(scene, {0, 1.5f, 0}, 1, 1, 5);
    scene.look({0, 1.2, -1.5}, {0, 0, 0.2}, 35);
    expect_no_bias(gradient_bias(scene.scene, {8, 32, 256}),
                   {area,
                    "glossy just over and under the roughness threshold: base and offset path would take different "
                    "shifts",
                    "a floor of metal, roughness 0.0099, 0.0101 and 0.002, and chalk, in stripes of three pixels",
                    "unbiased, whichever shift is taken", 0.3});
}

} // namespace
} // namespace gradus::testing
