#include "runtime/stages/trace_stage.h"

#include "kernels/shared/tables.h"

#include <chrono>

namespace gradus {

using namespace lib_float;

TraceCounts run_trace_stage(Tracer &tracer, const BatchTables &tables, std::uint32_t rays, std::uint32_t shadows,
                            double &trace_seconds) {
    const auto ray_view = tables.ray.map(Access::read_write);
    const auto shadow_view = tables.shadow.map(Access::read_write);
    float *ray = ray_view.as<float>(), *shadow = shadow_view.as<float>();
    const auto column = [&](float *table, int number) { return table + std::size_t(number) * tables.capacity; };

    RayColumns r;
    ShadowColumns s;
    for (int axis = 0; axis < 3; ++axis) {
        r.origin[axis] = column(ray, ray_origin_x + axis);
        r.direction[axis] = column(ray, ray_direction_x + axis);
        s.origin[axis] = column(shadow, shadow_origin_x + axis);
        s.direction[axis] = column(shadow, shadow_direction_x + axis);
    }
    r.primitive = reinterpret_cast<std::uint32_t *>(column(ray, ray_primitive));
    s.open = reinterpret_cast<std::uint32_t *>(column(shadow, shadow_open));

    const auto start = std::chrono::steady_clock::now();
    const TraceCounts counts = tracer.trace(r, rays, s, shadows);
    trace_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return counts;
}

std::uint64_t run_link_stage(Tracer &tracer, const Buffer &link, std::uint32_t capacity, std::uint32_t count,
                             double &trace_seconds) {
    if (count == 0)
        return 0;
    const auto view = link.map(Access::read_write);
    float *table = view.as<float>();
    const auto column = [&](int number) { return table + std::size_t(number) * 8 * capacity; };
    ShadowColumns s;
    for (int axis = 0; axis < 3; ++axis) {
        s.origin[axis] = column(link_origin_x + axis);
        s.direction[axis] = column(link_direction_x + axis);
    }
    s.open = reinterpret_cast<std::uint32_t *>(column(link_open));
    const auto start = std::chrono::steady_clock::now();
    const TraceCounts counts = tracer.trace(RayColumns{}, 0, s, count);
    trace_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return counts.shadow;
}

} // namespace gradus
