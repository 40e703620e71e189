#include "methods/photons/seen_distance.h"

#define TRAIT_TRIANGLES 1
#define TRAIT_SPHERES 1
#include "kernels/lib/camera_ray.h"
#include "kernels/lib/scene_hit.h"
#include "kernels/shared/tables.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace gradus {

using namespace lib_float;

double seen_distance(Session &session) {
    constexpr std::size_t side = 24, count = side * side;
    constexpr std::uint32_t unit = 1; // of FIELD_OF
    const SceneTables &tables = session.scene;
    const float *camera = tables.camera.data();
    std::vector<float> columns[6];
    for (std::size_t i = 0; i < count; ++i) {
        const float x = (float(i % side) + 0.5f) / side * float(session.film.width);
        const float y = (float(i / side) + 0.5f) / side * float(session.film.height);
        const vec3 direction = camera_direction(camera, unit, x, y);
        const float values[] = {camera[camera_origin_x],
                                camera[camera_origin_y],
                                camera[camera_origin_z],
                                direction.x,
                                direction.y,
                                direction.z};
        for (std::size_t column = 0; column < 6; ++column)
            columns[column].push_back(values[column]);
    }
    std::vector<std::uint32_t> primitives(count, ray_pending);
    RayColumns rays{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        rays.origin[axis] = columns[axis].data();
        rays.direction[axis] = columns[3 + axis].data();
    }
    rays.primitive = primitives.data();
    session.tracer.trace(rays, count, ShadowColumns{}, 0);
    std::vector<double> distances;
    for (std::size_t i = 0; i < count; ++i) {
        if (primitives[i] == ray_escaped)
            continue;
        const vec3 origin = v3(columns[0][i], columns[1][i], columns[2][i]);
        const vec3 direction = v3(columns[3][i], columns[4][i], columns[5][i]);
        const vec3 step = v3_sub(primitive_hit_of(tables.triangles.data(), tables.spheres.data(), unit,
                                                  tables.triangle_count, primitives[i], origin, direction)
                                     .position,
                                 origin);
        distances.push_back(std::sqrt(v3_dot(step, step)));
    }
    if (distances.empty())
        return tables.scene_diameter;
    const auto middle = distances.begin() + std::ptrdiff_t(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return *middle;
}

} // namespace gradus
