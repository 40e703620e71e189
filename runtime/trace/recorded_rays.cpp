#include "runtime/trace/recorded_rays.h"

#include "runtime/trace/ray_packets.h"

#include <numeric>

namespace gradus {

namespace {

/// Ray `lane` of a packet.
RTCRay ray_of(const RTCRay16 &packet, int lane) {
    RTCRay ray;
    ray.org_x = packet.org_x[lane], ray.org_y = packet.org_y[lane], ray.org_z = packet.org_z[lane];
    ray.dir_x = packet.dir_x[lane], ray.dir_y = packet.dir_y[lane], ray.dir_z = packet.dir_z[lane];
    ray.tnear = packet.tnear[lane], ray.tfar = packet.tfar[lane], ray.time = packet.time[lane];
    ray.mask = packet.mask[lane], ray.id = packet.id[lane], ray.flags = packet.flags[lane];
    return ray;
}

} // namespace

std::uint64_t RecordedRays::count() const {
    const std::uint64_t extensions = std::accumulate(extension_lanes.begin(), extension_lanes.end(), std::uint64_t(0));
    return std::accumulate(shadow_lanes.begin(), shadow_lanes.end(), extensions);
}

void trace_again(RTCScene scene, const RecordedRays &rays, bool extension_beams, bool shadow_beams, bool single) {
    for (std::size_t i = 0; i < rays.extension.size(); ++i) {
        const int lanes = rays.extension_lanes[i];
        TraceContext context(extension_beams, columns_of(rays.extension[i].ray));
        if (single) {
            for (int lane = 0; lane < lanes; ++lane) {
                RTCRayHit ray;
                ray.ray = ray_of(rays.extension[i].ray, lane);
                ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
                intersect(scene, context.embree, ray);
            }
        } else {
            alignas(64) RTCRayHit16 packet = rays.extension[i];
            intersect(first_lanes(lanes).lane, scene, context.embree, packet);
        }
    }
    for (std::size_t i = 0; i < rays.shadow.size(); ++i) {
        const int lanes = rays.shadow_lanes[i];
        TraceContext context(shadow_beams, columns_of(rays.shadow[i]));
        if (single) {
            for (int lane = 0; lane < lanes; ++lane) {
                RTCRay ray = ray_of(rays.shadow[i], lane);
                occlude(scene, context.embree, ray);
            }
        } else {
            alignas(64) RTCRay16 packet = rays.shadow[i];
            occlude(first_lanes(lanes).lane, scene, context.embree, packet);
        }
    }
}

} // namespace gradus
