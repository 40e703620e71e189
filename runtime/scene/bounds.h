// Boxes around what a scene has.
#pragma once

#include "runtime/scene/scene.h"
#include "runtime/scene/transform.h"

#include <algorithm>
#include <cmath>

namespace gradus {

/// Along the axes of world space; empty until something is added.
struct Bounds {
    Double3 lower{INFINITY, INFINITY, INFINITY}, upper{-INFINITY, -INFINITY, -INFINITY};

    void add(const Vector3 &point, double radius = 0) {
        const Double3 at = to_double(point);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            lower[axis] = std::min(lower[axis], at[axis] - radius);
            upper[axis] = std::max(upper[axis], at[axis] + radius);
        }
    }
    void add(const Bounds &other) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            lower[axis] = std::min(lower[axis], other.lower[axis]);
            upper[axis] = std::max(upper[axis], other.upper[axis]);
        }
    }
    /// The longest edge; 0 of nothing.
    double extent() const { return std::max({0.0, upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]}); }
};

/// What of the mesh can be hit.
inline Bounds bounds_of(const Mesh &mesh) {
    Bounds bounds;
    for (const auto &triangle : mesh.triangles)
        for (const std::uint32_t index : triangle)
            bounds.add(mesh.positions[index]);
    return bounds;
}

/// What of the shape can be hit.
inline Bounds bounds_of(const Scene &scene, const Shape &shape) {
    if (shape.kind == Shape::Kind::sphere) {
        Bounds bounds;
        const Sphere &sphere = scene.spheres.at(shape.geometry);
        bounds.add(sphere.center, sphere.radius);
        return bounds;
    }
    return bounds_of(scene.meshes.at(shape.geometry));
}

} // namespace gradus
