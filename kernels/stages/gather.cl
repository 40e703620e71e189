/* gather: camera paths that met a surface that is rough enough leave a gather point there: paths at places `first` on
 * of `index` in rows `to` on of `gather`.
 *
 * Photons are gathered from a disc whose radius goes with what a pixel covers there: `radius_slope` times the length of
 * the path from the camera, within [radius_start, radius_most], times `radius_scale`, which shrinks from pass to pass;
 * but at least LEAST_SHARE of the point's coordinates, and LEAST_OFFSETS times what it may be off its surface:
 * positions are not exact to much less.
 *
 * BY_SLOT: in the rows of their slots instead.
 *
 * TRAIT_OPACITY: `throughput`, which is for photons alone, makes up for those that passed.
 *
 * FEATURES: also leaves the features that the camera sees, in the place of `shade` (by BSDF kind). */
//! traits: TRAIT_OPACITY
#include "kernels/lib/bsdf.h"
#include "kernels/lib/bsdf_frame.h"
#include "kernels/lib/camera_way.h"
#include "kernels/lib/seen_features.h"
#include "kernels/lib/surface_point.h"
#include "kernels/lib/textured_material.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/stage.h"

#define LEAST_SHARE R(0x1p-18)
#define LEAST_OFFSETS R(16)

STAGE gather(uint count, uint unit, uint first, uint to, uint capacity, uint gather_rows, uint max_depth,
             __global const uint *index, __global const real *path_old, __global const real *ray_old,
             __global const real *travelled, __global real *gather, __global const real *triangles,
             __global const real *triangle_normals, __global const real *triangle_tangents,
             __global const real *spheres, uint triangle_count, __global const uint *primitive_material,
             __global const uint *material_back, __global const uint *material_kind, real radius_slope,
             real radius_start, real radius_most, real radius_scale SURFACE_ARGUMENT CAMERA_WAY_ARGUMENT
#if FEATURES
             ,
             __global const real *materials, __global real *feature, uint slots
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const int old = AT_INDEX(first + i);
    const vec3 origin = AT_V3_IN(ray_old, ray, origin, old), direction = AT_V3_IN(ray_old, ray, direction, old);
    const uint depth = AT_UINT_IN(path_old, path, depth, old), slot = AT_UINT_IN(path_old, path, slot, old);
    const rgb throughput = AT_RGB_IN(path_old, path, throughput, old);
    const surface_point point = CHOSEN_POINT(
        surface_point_of(triangles, triangle_normals, triangle_tangents, spheres, unit, triangle_count,
                         primitive_material, material_back,
                         AT_UINT_IN(ray_old, ray, primitive, old) INSTANCE_IN(ray_old, ray, old), origin, direction),
        capacity, old);
#if BY_SLOT
    (void)to;
    const size_t row = slot;
#else
    const size_t row = to + i;
#endif
    const vec3 step = v3_sub(point.position, origin);
    const real distance = r_sqrt(v3_dot(step, step)) + WAY_BEFORE(depth, direction);
    const real before = travelled[slot];
    const real length = distance + (depth > 0u ? before : R(0));
    AT_UINT(gather, slot, row) = slot;
    AT_UINT(gather, deepest, row) = max_depth - depth - 1u;
    const real first_radius = r_clamp(length * radius_slope, radius_start, radius_most);
    const vec3 at = point.position;
    const real coordinate = r_max(r_max(r_abs(at.x), r_abs(at.y)), r_abs(at.z));
    const real least = r_max(LEAST_SHARE * coordinate, LEAST_OFFSETS * point.offset);
    AT(gather, radius, row) = r_max(first_radius * radius_scale, least);
#if TRAIT_OPACITY
    /* Photons are here in the share that the surface meets, and so is this path: one of both is enough. */
    const real met = (real)AT_UINT_IN(ray_old, ray, opacity, old) * (R(1) / (real)ray_opacity_one);
    SET_RGB(gather, throughput, row, rgb_scale(throughput, R(1) / r_max(met, R(1e-6))));
#else
    SET_RGB(gather, throughput, row, throughput);
#endif
    SET_RGB(gather, sum, row, rgb_gray(R(0)));
    SET_SURFACE_VERTEX(gather, row, material_kind[point.material], point, direction)
    SET_VERTEX_TEXTURED(gather, row, capacity, old)
#if FEATURES
    const material m = HIT_MATERIAL(point.material, capacity, old);
    const rgb albedo = PASTE(BSDF, _albedo)(m);
    const bsdf_frame place = HIT_FRAME(point, m, v3_neg(direction), capacity, old);
    SET_SEEN_FEATURES(slot, depth, 0, distance, throughput, albedo, place.axes.n)
#endif
}
