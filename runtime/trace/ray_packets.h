// Rays of tables in Embree's packets.
#pragma once

#include "runtime/trace/embree.h"
#include "runtime/trace/ray_order.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gradus {

constexpr int packet_width = 16; ///< rays

/// Which lanes of a packet are rays.
struct alignas(64) ValidLanes {
    int lane[packet_width];
};

inline ValidLanes first_lanes(int lanes) {
    ValidLanes valid;
    for (int lane = 0; lane < packet_width; ++lane)
        valid.lane[lane] = lane < lanes ? -1 : 0;
    return valid;
}

/// Sets what never changes from packet to packet.
template <class Ray>
void prepare_packet(Ray &ray) {
    for (int lane = 0; lane < packet_width; ++lane) {
        ray.tnear[lane] = 0;
        ray.time[lane] = 0;
        ray.mask[lane] = 0xFFFFFFFFu;
        ray.id[lane] = unsigned(lane); // TraceContext
        ray.flags[lane] = 0;
    }
}

/// Where the columns of a packet's origins and directions are.
struct SegmentLanes {
    float *origin[3], *direction[3];
};

/// Takes sixteen of the rays.
void gather_segments(const SegmentColumns &rays, const std::uint32_t *rows, const SegmentLanes &lanes);

/// Puts those rays into the packet, which end at parameter `far`.
template <class Ray>
void fill_packet(Ray &ray, const SegmentColumns &rays, const std::uint32_t *rows, float far) {
    gather_segments(rays, rows, {{ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}});
    for (int lane = 0; lane < packet_width; ++lane)
        ray.tfar[lane] = far;
}

/// Of the first `lanes`, those whose rays are of numbers that Embree takes: not NaN, infinite or absurdly large, as an
/// absurd camera makes them.
template <class Ray>
ValidLanes sane_lanes(const Ray &ray, int lanes) {
    constexpr float most = 1e18f; // Embree's own limit is 1.8e18
    ValidLanes valid = first_lanes(lanes);
    for (const float *values : {ray.org_x, ray.org_y, ray.org_z, ray.dir_x, ray.dir_y, ray.dir_z})
        for (int lane = 0; lane < packet_width; ++lane)
            valid.lane[lane] &= -int(std::abs(values[lane]) < most); // NaN is not
    return valid;
}

/// What is known to filters of hits. Within an instance Embree hands them the ray in the frame of its group; that of
/// the world is ray `id` of these.
struct TraceContext {
    RayQuery embree; ///< first: filters are given its address
    const float *origin[3], *direction[3];
    const std::uint32_t *rows = nullptr; ///< of ray `id`; null: that number itself
    bool passes_emitters = false;        ///< rays of a camera that sees none
    bool without_chance = false;         ///< RayColumns::without_chance

    TraceContext(bool beams, const SegmentColumns &rays) : embree(beams) {
        std::copy_n(rays.origin, 3, origin);
        std::copy_n(rays.direction, 3, direction);
    }
};

/// Rays of a packet that is kept elsewhere, as columns.
template <class Ray>
SegmentColumns columns_of(const Ray &ray) {
    return {{ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}};
}

/// Calls visit(rows, lanes) for packet after packet of the sorted rows. `rows` has 16 elements, the last repeated past
/// `lanes`. Where packets are traced as beams none spans two octants.
template <class Visit>
void for_each_packet(const std::vector<std::uint32_t> &rows, const std::vector<std::uint32_t> &groups, bool beams,
                     Visit visit) {
    const std::size_t parts = beams ? groups.size() - 1 : 1;
    for (std::size_t part = 0; part < parts; ++part) {
        const std::size_t begin = beams ? groups[part] : 0, end = beams ? groups[part + 1] : rows.size();
        std::size_t i = begin;
        for (; i + packet_width <= end; i += packet_width)
            visit(&rows[i], packet_width);
        if (i < end) {
            std::uint32_t last[packet_width];
            for (std::size_t lane = 0; lane < packet_width; ++lane)
                last[lane] = rows[std::min(i + lane, end - 1)];
            visit(last, static_cast<int>(end - i));
        }
    }
}

} // namespace gradus
