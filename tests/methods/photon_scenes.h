// Scenes in which photons are gathered where that goes wrong.
#pragma once

#include "tests/support/small_scenes.h"

#include <string>

namespace gradus::testing {

/// A closed box of two metres with a lamp inside, seen from outside. `between`: the walls' thickness; 0: one sheet.
/// A ball in it is two-sided, so that walls of one side and of both have the same kernels.
inline Scene thin_walls(double between, bool both_sides) {
    SceneMaker maker(24, 2);
    maker.look({0, 0, -6}, {0, 0, 0}, 30);
    maker.scene.settings.rr_depth = 5;
    const std::uint32_t gray = maker.material(both_sides ? two_sided(diffuse(0.7)) : material_of(diffuse(0.7)));
    maker.cube(gray, -1, true);
    maker.sphere({0, 0, 0}, 0.2f, gray, maker.emitter(Emitter::Kind::area, {10, 10, 10}));
    maker.sphere({0, 0.5f, 0}, 0.1f, maker.material(two_sided(diffuse(0.7))));
    if (between > 0) {
        maker.cube(gray);
        const float factor = float(1 + between);
        for (Vector3 &p : maker.scene.meshes.back().positions)
            p = {factor * p.x, factor * p.y, factor * p.z};
    }
    return maker.scene;
}

/// A block of glass on the floor but for 1 mm, in which light goes around by total internal reflection, or a lens of 90
/// triangles.
inline void add_glass(SceneMaker &maker, const std::string &piece, std::uint32_t material) {
    if (piece == "a block") {
        maker.cube(material);
        for (Vector3 &p : maker.scene.meshes.back().positions)
            p = {0.4f * p.x, 0.3f * p.y + 0.301f, 0.4f * p.z};
    } else {
        maker.scene.meshes.push_back(coarse_ball({0, 1.4f, 0}, 0.5, piece == "a smooth lens"));
        maker.shape(Shape::Kind::mesh, maker.scene.meshes.size() - 1, material, -1);
    }
}

/// The floor under such a piece under a lamp that path tracing can find: to `maker`, of which it takes the camera.
inline void add_floor_under_glass(SceneMaker &maker, const std::string &piece) {
    maker.look({0, 0.5, -2.5}, {0, 0, 0}, 25);
    maker.scene.settings.max_depth = 10;
    const std::uint32_t white = maker.material(diffuse(0.8)), clear = maker.material(glass(1.5));
    maker.floor(-2, 2, 2, white);
    maker.lamp({0, 3, 0}, 1.5f, 1.5f, 10, white);
    add_glass(maker, piece, clear);
}

} // namespace gradus::testing
