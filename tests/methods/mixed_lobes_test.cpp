// Gradient-domain path tracing where a surface has a mirror beside a rough lobe, and the lobe is part of the path.
#include "tests/methods/gradient_bias.h"
#include "tests/support/small_scenes.h"

#include <gtest/gtest.h>

namespace gradus::testing {
namespace {

// A room of plastic that mirrors much, so that paths come to vertices by either lobe and leave by the other one; a ball
// of plastic and a mirror before it, whose neighbours are of other kinds.
TEST(FullMixedLobes, AreUnbiasedInARoomOfPlastic) {
    SceneMaker scene = scene_for_bias(6);
    const std::uint32_t white = scene.material(two_sided(plastic(0.6, 2.2)));
    const std::uint32_t dark = scene.material(two_sided(plastic(0.15, 1.5)));
    scene.parallelogram({-1, -1, 1}, {0, 2, 0}, {1, 0, 0}, white);
    scene.parallelogram({0, -1, 1}, {0, 2, 0}, {1, 0, 0}, dark);
    scene.floor(-1, 1, 1, white, -1);
    scene.parallelogram({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, dark);
    scene.lamp({0, 0.99f, 0}, 1.6f, 1.6f, 3, scene.material(two_sided(diffuse(0.2))));
    scene.sphere({-0.4f, -0.5f, 0}, 0.45f, white);
    scene.parallelogram({0.2f, -0.9f, 0.3f}, {0.1f, 0.8f, 0}, {0.5f, 0, -0.2f}, scene.material(two_sided(mirror())));
    scene.look({0.1, 0.05, -3}, {0, 0, 0}, 36);
    expect_no_bias(gradient_bias(scene.scene, {8, 64, 256}),
                   {"Half-vector copy", "a surface that mirrors and scatters: base and offset path take other lobes",
                    "a room of plastic with a mirror in it",
                    "the lobe is part of the path; where a way back is missing both fail; unbiased", 0.15});
}

// Strips of plastic and of mirror, side by side, which mirror a lamp onto a wall: base and offset paths come to both,
// and paths that reconnect to the plastic find the lamp by its mirror, from which no path reconnects.
TEST(MixedLobes, AreUnbiasedWhereTheyThrowACaustic) {
    SceneMaker scene = scene_for_bias(4);
    const std::uint32_t dull = scene.material(two_sided(plastic(0.1, 4)));
    const std::uint32_t polished = scene.material(two_sided(mirror())), grey = scene.material(two_sided(diffuse(0.5)));
    for (int i = 0; i < 8; ++i)
        scene.parallelogram({-1 + 0.25f * float(i), -1, -1}, {0, 0, 2}, {0.25f, 0, 0}, i % 2 ? polished : dull);
    scene.parallelogram({-1, -1, 1}, {0, 2, 0}, {2, 0, 0}, grey);
    scene.lamp({0.1f, -0.5f, 0.5f}, 0.7f, 0.5f, 6, grey);
    scene.look({0, 0.3, -3}, {0, -0.3, 0}, 36);
    expect_no_bias(gradient_bias(scene.scene, {8, 64, 64}),
                   {"Half-vector copy", "a surface that mirrors and scatters: base and offset path take other lobes",
                    "strips of plastic and mirror below a lamp",
                    "the lobe is part of the path; where a way back is missing both fail; unbiased", 0.15});
}

// A floor of plastic mirrors a lamp, and a wall of rough metal mirrors the floor. Paths from the wall reconnect to the
// floor and then take its mirror: from where the offset path comes that shows something else than the lamp. Strips of
// smoother metal, where paths copy, so that some offset paths are connected there and some are not.
TEST(FullMixedLobes, AreUnbiasedWhereMetalShowsWhatPlasticMirrors) {
    SceneMaker scene = scene_for_bias(4);
    const std::uint32_t black = scene.material(two_sided(diffuse(0)));
    scene.floor(-2, 2, 2, scene.material(two_sided(plastic(0.1, 4))), -1);
    const std::uint32_t metal[] = {scene.material(two_sided(rough_metal(0.06))),
                                   scene.material(two_sided(rough_metal(0.009)))};
    for (int i = 0; i < 16; ++i)
        scene.parallelogram({-0.8f + 0.1f * float(i), -1, 1}, {0, 2, 0}, {0.1f, 0, 0}, metal[i % 2]);
    scene.lamp({0, -0.4f, -1.1f}, 0.9f, 0.5f, 5, black);
    scene.look({0, 1.5, -1.5}, {0, -0.2, 1}, 22);
    expect_no_bias(gradient_bias(scene.scene, {8, 256, 512}),
                   {"Half-vector copy", "a surface that mirrors and scatters: base and offset path take other lobes",
                    "a lamp in plastic in rough metal",
                    "the lobe is part of the path; where a way back is missing both fail; unbiased", 0.15, 0.015});
}

} // namespace
} // namespace gradus::testing
