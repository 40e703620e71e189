// <shape type="sphere">, its front outside.
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

#include <algorithm>
#include <cmath>

namespace gradus {

Declaration declare_shape_sphere() {
    return {"its front outside", joined({{Parameter{"center", Takes::point, "0 0 0", "before to_world"}.in("lengths"),
                                          Parameter{"radius", Takes::number, "1",
                                                    "before to_world; 2.0 and later: one below 0 turns it inside out"}
                                              .in("lengths")},
                                         parameters_of_any_shape()})};
}

ShapeGeometry shape_sphere(Properties &properties, SceneBuilder &) {
    const Double3 local_center = properties.point("center");
    const double radius = properties.number("radius");
    const Matrix4 to_world = properties.transform("to_world");
    const double factor = uniform_scale(to_world);
    if (!(factor > 0))
        throw properties.error("to_world", "a sphere's to_world must scale all directions alike: no other scale, no "
                                           "shear; an ellipsoid needs a mesh");
    const bool is_legacy = properties.element().is_legacy();
    if (!(std::isnormal(float(radius * factor))) || (radius < 0 && is_legacy))
        throw properties.error("radius", "a sphere needs a positive radius of moderate size");
    Sphere sphere;
    const Double3 center = transform_point(to_world, local_center);
    sphere.center = to_float(center);
    sphere.radius = float(std::fabs(radius) * factor);
    // Mitsuba 3 turns a sphere inside out when it is mirrored or its radius is negative; 0.x does not.
    const bool is_mirrored = (determinant(to_world) < 0) != (radius < 0);
    sphere.flip_normals = properties.boolean("flip_normals") != (is_mirrored && !is_legacy);
    for (int axis = 0; axis < 3; ++axis)
        sphere.axes[std::size_t(axis)] =
            to_float(scale({to_world.m[axis], to_world.m[4 + axis], to_world.m[8 + axis]}, 1 / factor));
    if (!std::isfinite(sphere.center.x) || !std::isfinite(sphere.center.y) || !std::isfinite(sphere.center.z))
        throw properties.error("center", "the sphere's center is out of range");
    return PlacedSphere{sphere, center};
}

} // namespace gradus
