#include "methods/photons/seen_distances.h"

#include "runtime/trace/camera_rays.h"

#include <cmath>

namespace gradus {

using namespace lib_float;

std::vector<double> seen_distances(Session &session) {
    constexpr std::size_t side = 64, count = side * side;
    const SceneTables &tables = session.scene;
    CameraRays rays;
    rays.trace(tables, session.tracer, count, [&](std::size_t i) {
        return CameraPlace{(float(i % side) + 0.5f) / side * float(session.film.width),
                           (float(i / side) + 0.5f) / side * float(session.film.height)};
    });
    std::vector<double> distances;
    for (std::size_t i = 0; i < count; ++i) {
        if (rays.primitive(i) == ray_escaped)
            continue;
        const vec3 step = v3_sub(rays.hit(tables, i).position, rays.origin(i));
        distances.push_back(std::sqrt(v3_dot(step, step)) + rays.way_before(tables, i));
    }
    if (distances.empty())
        distances.push_back(tables.scene_diameter);
    return distances;
}

} // namespace gradus
