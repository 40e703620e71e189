// <shape type="sphere">, its front outside.
//   center (0, 0, 0), radius (1), to_world (applied to both; no stretching), flip_normals
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

#include <algorithm>
#include <cmath>

namespace gradus {

ShapeGeometry shape_sphere(Properties &properties, SceneBuilder &) {
    claim_attachments(properties);
    const Double3 center = properties.point("center", {0, 0, 0});
    const double radius = properties.number("radius", 1);
    const Matrix4 to_world = properties.transform("to_world");
    const double factor = uniform_scale(to_world);
    if (!(factor > 0))
        throw properties.error("to_world", "a sphere's to_world must scale all directions alike: no other scale, no "
                                           "shear; an ellipsoid needs a mesh");
    const bool is_legacy = properties.element().is_legacy();
    if (!(std::isnormal(float(radius * factor))) || (radius < 0 && is_legacy))
        throw properties.error("radius", "a sphere needs a positive radius of moderate size");
    Sphere sphere;
    sphere.center = to_float(transform_point(to_world, center));
    sphere.radius = float(std::fabs(radius) * factor);
    // Mitsuba 3 turns a sphere inside out when it is mirrored or its radius is negative; 0.x does not.
    const bool is_mirrored = (determinant(to_world) < 0) != (radius < 0);
    sphere.flip_normals = properties.boolean("flip_normals", false) != (is_mirrored && !is_legacy);
    for (int axis = 0; axis < 3; ++axis)
        sphere.axes[std::size_t(axis)] =
            to_float(scale({to_world.m[axis], to_world.m[4 + axis], to_world.m[8 + axis]}, 1 / factor));
    properties.ignore({"face_normals"});
    if (!std::isfinite(sphere.center.x) || !std::isfinite(sphere.center.y) || !std::isfinite(sphere.center.z))
        throw properties.error("center", "the sphere's center is out of range");
    return sphere;
}

} // namespace gradus
