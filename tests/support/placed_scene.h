// Scenes of other sizes and in other places.
#pragma once

#include "runtime/scene/scene.h"
#include "runtime/scene/transform.h"

namespace gradus::testing {

/// Every position p becomes factor p + offset.
inline void place(Scene &scene, double factor, const Double3 &offset) {
    const auto placed = [&](Vector3 p) { return to_float(add(scale(to_double(p), factor), offset)); };
    for (Mesh &mesh : scene.meshes)
        for (Vector3 &p : mesh.positions)
            p = placed(p);
    for (Sphere &sphere : scene.spheres) {
        sphere.center = placed(sphere.center);
        sphere.radius = float(sphere.radius * factor);
    }
    Camera &camera = scene.camera;
    for (double *length : {&camera.near_clip, &camera.far_clip, &camera.aperture_radius, &camera.focus_distance})
        *length *= factor;
    for (int axis = 0; axis < 3; ++axis) {
        double &origin = camera.to_world.m[std::size_t(axis) * 4 + 3];
        origin = factor * origin + offset[axis];
    }
}

} // namespace gradus::testing
