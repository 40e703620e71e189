// What a scene goes through before it is rendered, wherever it lies and in whatever unit.
#pragma once

#include "runtime/scene/long_triangles.h"
#include "runtime/scene/own_origin.h"
#include "runtime/scene/own_scale.h"

namespace gradus {

/// bring_to_own_scale(), whose factor it returns, and bring_to_own_origin(): in that order, so that errors tell places
/// and warnings as the file has them. Then begin_at_widest_corners().
inline double bring_to_own_frame(Scene &scene, const std::function<void(const std::string &)> &warn = {}) {
    const double factor = bring_to_own_scale(scene, warn);
    bring_to_own_origin(scene);
    begin_at_widest_corners(scene);
    return factor;
}

} // namespace gradus
