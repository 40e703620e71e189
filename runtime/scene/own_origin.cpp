#include "runtime/scene/own_origin.h"

#include "runtime/scene/instances.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace gradus {
namespace {

constexpr double extents_away = 8; ///< and no more: usual scenes keep their numbers

} // namespace

Double3 own_origin_of(const Bounds &bounds) {
    const double extent = bounds.extent();
    const Double3 middle = scale(add(bounds.lower, bounds.upper), 0.5);
    const double away = std::max({std::abs(middle[0]), std::abs(middle[1]), std::abs(middle[2])});
    if (!(extent > 0 && std::isfinite(away) && away > extents_away * extent))
        return {0, 0, 0};
    return middle;
}

void bring_to_own_origin(Scene &scene) {
    const Double3 middle = own_origin_of(world_bounds(scene));
    if (middle == Double3{0, 0, 0})
        return;
    const auto moved = [&](const Vector3 &position) { return to_float(subtract(to_double(position), middle)); };
    std::vector<bool> is_of_world(scene.meshes.size()); // those of groups are in the groups' frames
    for (const Shape &shape : scene.shapes)
        if (shape.kind == Shape::Kind::mesh && shape.group == no_group)
            is_of_world[shape.geometry] = true;
    for (std::size_t i = 0; i < scene.meshes.size(); ++i)
        if (is_of_world[i])
            for (Vector3 &position : scene.meshes[i].positions)
                position = moved(position);
    for (Instance &instance : scene.instances)
        for (std::size_t axis = 0; axis < 3; ++axis)
            instance.to_world[4 * axis + 3] = float(instance.to_world[4 * axis + 3] - middle[axis]);
    for (Sphere &sphere : scene.spheres)
        sphere.center = moved(sphere.center);
    for (Emitter &emitter : scene.emitters)
        if (emitter.shines_from_a_point())
            emitter.position = moved(emitter.position);
    for (std::size_t axis = 0; axis < 3; ++axis)
        scene.camera.to_world.m[4 * axis + 3] -= middle[axis];
}

} // namespace gradus
