#include "runtime/stages/trace_stage.h"

#include "kernels/shared/tables.h"

#include <chrono>
#include <optional>

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

std::uint64_t run_offset_stage(Tracer &tracer, const Buffer &link, std::uint32_t links, const Buffer *offset_ray,
                               std::uint32_t rays, std::uint32_t capacity, double &trace_seconds) {
    if (links == 0 && rays == 0)
        return 0;
    const auto link_view = link.map(Access::read_write);
    const auto link_column = [&](int number) { return link_view.as<float>() + std::size_t(number) * 8 * capacity; };
    ShadowColumns s;
    for (int axis = 0; axis < 3; ++axis) {
        s.origin[axis] = link_column(link_origin_x + axis);
        s.direction[axis] = link_column(link_direction_x + axis);
    }
    s.open = reinterpret_cast<std::uint32_t *>(link_column(link_open));
    RayColumns r{};
    std::optional<Buffer::Mapping> ray_view;
    if (rays > 0) {
        ray_view.emplace(*offset_ray, Access::read_write);
        const auto column = [&](int number) { return ray_view->as<float>() + std::size_t(number) * 4 * capacity; };
        for (int axis = 0; axis < 3; ++axis) {
            r.origin[axis] = column(offset_ray_origin_x + axis);
            r.direction[axis] = column(offset_ray_direction_x + axis);
        }
        r.primitive = reinterpret_cast<std::uint32_t *>(column(offset_ray_primitive));
    }
    const auto start = std::chrono::steady_clock::now();
    const TraceCounts counts = tracer.trace(r, rays, s, links);
    trace_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return counts.extension + counts.shadow;
}

} // namespace gradus
