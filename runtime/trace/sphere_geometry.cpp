#include "runtime/trace/sphere_geometry.h"

#include "runtime/trace/clones.h"
#include "runtime/trace/ray_packets.h"

#include <cmath>
#include <limits>

namespace gradus {

namespace {

/// Columns of a packet's rays, and which of them ask.
struct Rays {
    Rays(RTCRayN *rays, const int *valid, unsigned width)
        : origin{&RTCRayN_org_x(rays, width, 0), &RTCRayN_org_y(rays, width, 0), &RTCRayN_org_z(rays, width, 0)},
          direction{&RTCRayN_dir_x(rays, width, 0), &RTCRayN_dir_y(rays, width, 0), &RTCRayN_dir_z(rays, width, 0)},
          near(&RTCRayN_tnear(rays, width, 0)), far(&RTCRayN_tfar(rays, width, 0)), valid(valid) {}
    const float *origin[3], *direction[3], *near;
    float *far;
    const int *valid;
};

/// Says of each ray that asks whether it meets the sphere between its ends, as -1, and puts there into `found` the
/// nearest parameter, else its end. As sphere_hit() of kernels/lib/primitive.h, with directions of any length. Where
/// none comes near, it returns false and leaves these.
__attribute__((always_inline)) inline bool meet(const TracedSphere &sphere, const Rays &rays, unsigned width,
                                                float *__restrict found, int *__restrict is_met) {
    const float *__restrict ox = rays.origin[0], *__restrict oy = rays.origin[1], *__restrict oz = rays.origin[2];
    const float *__restrict dx = rays.direction[0], *__restrict dy = rays.direction[1],
                            *__restrict dz = rays.direction[2];
    const float *__restrict near = rays.near, *__restrict far = rays.far;
    const int *__restrict valid = rays.valid;
    const float square = sphere.radius * sphere.radius;
    alignas(64) float along[packet_width], discriminants[packet_width], inverses[packet_width], beyond[packet_width];
    int any = 0;
    for (unsigned i = 0; i < width; ++i) {
        const float fx = ox[i] - sphere.center[0], fy = oy[i] - sphere.center[1], fz = oz[i] - sphere.center[2];
        const float inverse = 1 / (dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i]);
        const float b = -(fx * dx[i] + fy * dy[i] + fz * dz[i]) * inverse;
        const float cx = fx + b * dx[i], cy = fy + b * dy[i], cz = fz + b * dz[i];
        const float discriminant = square - (cx * cx + cy * cy + cz * cz);
        along[i] = b;
        discriminants[i] = discriminant;
        inverses[i] = inverse;
        beyond[i] = fx * fx + fy * fy + fz * fz - square;
        any |= discriminant >= 0 ? valid[i] : 0;
    }
    if (any == 0)
        return false;
    for (unsigned i = 0; i < width; ++i) {
        const float b = along[i], discriminant = discriminants[i];
        const float half = std::sqrt(std::max(discriminant, 0.0f) * inverses[i]);
        const float q = b + std::copysign(half, b);
        const float other = beyond[i] * inverses[i] / q;
        const float first = std::min(q, other), second = std::max(q, other);
        const int first_counts = (first > near[i] ? -1 : 0) & (first <= far[i] ? -1 : 0);
        const int second_counts = (second > near[i] ? -1 : 0) & (second <= far[i] ? -1 : 0);
        const int met = valid[i] & (first_counts | second_counts) & (discriminant >= 0 ? -1 : 0);
        const float nearest = first_counts != 0 ? first : second;
        found[i] = met != 0 ? nearest : far[i];
        is_met[i] = met;
    }
    return true;
}

GRADUS_CLONES bool meet_packet(const TracedSphere &sphere, const Rays &rays, float *found, int *is_met) {
    return meet(sphere, rays, packet_width, found, is_met);
}

bool find(const TracedSphere &sphere, const Rays &rays, unsigned width, float *found, int *is_met) {
    return width == packet_width ? meet_packet(sphere, rays, found, is_met) : meet(sphere, rays, width, found, is_met);
}

const TracedSphere &sphere_of(void *spheres, unsigned number) {
    return static_cast<const TracedSphere *>(spheres)[number];
}

void intersect(const RTCIntersectFunctionNArguments *arguments) {
    const unsigned width = arguments->N;
    const Rays rays(RTCRayHitN_RayN(arguments->rayhit, width), arguments->valid, width);
    alignas(64) float found[packet_width];
    alignas(64) int is_met[packet_width];
    if (!find(sphere_of(arguments->geometryUserPtr, arguments->primID), rays, width, found, is_met))
        return;
    RTCHitN *hits = RTCRayHitN_HitN(arguments->rayhit, width);
    unsigned *primitive = &RTCHitN_primID(hits, width, 0), *geometry = &RTCHitN_geomID(hits, width, 0);
    unsigned *instance = &RTCHitN_instID(hits, width, 0, 0); // what was met before may be of one
    for (unsigned i = 0; i < width; ++i) {
        rays.far[i] = found[i];
        primitive[i] = is_met[i] != 0 ? arguments->primID : primitive[i];
        geometry[i] = is_met[i] != 0 ? arguments->geomID : geometry[i];
        instance[i] = is_met[i] != 0 ? arguments->context->instID[0] : instance[i];
    }
}

void occlude(const RTCOccludedFunctionNArguments *arguments) {
    const unsigned width = arguments->N;
    const Rays rays(arguments->ray, arguments->valid, width);
    alignas(64) float found[packet_width];
    alignas(64) int is_met[packet_width];
    if (!find(sphere_of(arguments->geometryUserPtr, arguments->primID), rays, width, found, is_met))
        return;
    for (unsigned i = 0; i < width; ++i)
        rays.far[i] = is_met[i] != 0 ? -std::numeric_limits<float>::infinity() : rays.far[i];
}

void bound(const RTCBoundsFunctionArguments *arguments) {
    const TracedSphere &sphere = sphere_of(arguments->geometryUserPtr, arguments->primID);
    constexpr float out = std::numeric_limits<float>::infinity();
    const auto low = [&](int axis) { return std::nextafter(sphere.center[axis] - sphere.radius, -out); };
    const auto high = [&](int axis) { return std::nextafter(sphere.center[axis] + sphere.radius, out); };
    RTCBounds &box = *arguments->bounds_o;
    box.lower_x = low(0), box.lower_y = low(1), box.lower_z = low(2);
    box.upper_x = high(0), box.upper_y = high(1), box.upper_z = high(2);
}

} // namespace

RTCGeometry new_sphere_geometry(RTCDevice device, const TracedSphere *spheres, unsigned count) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, count);
    rtcSetGeometryUserData(geometry, const_cast<TracedSphere *>(spheres));
    rtcSetGeometryBoundsFunction(geometry, bound, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect);
    rtcSetGeometryOccludedFunction(geometry, occlude);
    return geometry;
}

} // namespace gradus
