// What tests of photon mapping's images share.
#pragma once

#include "tests/support/render.h"
#include "tests/support/small_scenes.h"

namespace gradus::testing {

inline RenderOptions with_radius(double value, bool of_scene, double alpha = 1) {
    RenderOptions options;
    options.radius = RenderOptions::GatherRadius{value, of_scene};
    options.radius_alpha = alpha;
    return options;
}

/// A sphere that all light stays in: it emits 1 everywhere, so 1 / (1 - albedo) is seen everywhere. The part of a
/// sphere within a distance r of one of its points has the area pi r^2 whatever its own radius: there is no bias.
inline Scene furnace(const Bsdf &bsdf, std::uint64_t passes, std::uint32_t size = 16) {
    SceneMaker maker(size, passes);
    maker.look({0.1, 0.2, -0.3}, {0, 0, 1}, 60);
    maker.sphere({0, 0, 0}, 1, maker.material(bsdf), maker.emitter(Emitter::Kind::area, {1, 1, 1}), true);
    maker.scene.settings.rr_depth = 5;
    return maker.scene;
}

} // namespace gradus::testing
