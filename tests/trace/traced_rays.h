// Rays by columns, what a tracer says of them, and scenes of one mesh that they are sent at.
#pragma once

#include "runtime/trace/tracer.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "kernels/shared/tables.h"

namespace gradus::testing {

inline Scene scene_of(Mesh mesh) {
    Scene scene;
    scene.materials.resize(1);
    scene.meshes.push_back(std::move(mesh));
    scene.shapes.emplace_back();
    return scene;
}

using Columns = std::array<std::vector<float>, 6>; ///< origin and direction

inline void append(Columns &columns, const std::array<float, 6> &ray) {
    for (std::size_t column = 0; column < 6; ++column)
        columns[column].push_back(ray[column]);
}

/// As rays or as shadow rays; without a place for answers.
template <class Segments>
Segments segments_of(const Columns &columns) {
    Segments segments{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        segments.origin[axis] = columns[axis].data();
        segments.direction[axis] = columns[3 + axis].data();
    }
    return segments;
}

struct Answers {
    std::vector<std::uint32_t> primitive, open; ///< of rays, and of shadow rays to parameter 1
};

inline Answers traced(Tracer &tracer, const Columns &columns) {
    const std::size_t rays = columns[0].size();
    Answers answers{std::vector<std::uint32_t>(rays, ray_pending), std::vector<std::uint32_t>(rays, 1)};
    auto ray = segments_of<RayColumns>(columns);
    auto shadow = segments_of<ShadowColumns>(columns);
    ray.primitive = answers.primitive.data();
    shadow.open = answers.open.data();
    tracer.trace(ray, rays, shadow, rays);
    return answers;
}

} // namespace gradus::testing
