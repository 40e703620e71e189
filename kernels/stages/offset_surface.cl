/* offset_surface: the new vertices of offset paths that are apart from their base path, and what will become of them.
 * Only with TRAIT_APART. */
//! traits: TRAIT_SHADING_NORMALS TRAIT_ANISOTROPIC TRAIT_SHIFT_DISTANCE
#include "kernels/lib/gradient.h"
#include "kernels/lib/reconnectable.h"
#include "kernels/lib/surface_point.h"

/* Of first vertices, rows `first` on: those that the neighbours' own paths see. */
STAGE offset_begin(uint count, uint first, uint capacity, uint slots, __global const real *vertex,
                   __global const real *primary, __global const uint *material_kind, __global real *offset_vertex,
                   __global real *shifted, __global uint *offset_state, FILM_PLACE
#if TRAIT_SHIFT_DISTANCE
                   ,
                   __global real *offset_reach, real shift_distance
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = first + i;
    const uint slot = AT_UINT(vertex, slot, row);
    const film_pixel pixel = PIXEL_OF(slot);
    int all_rough = (material_kind[AT_UINT(vertex, material, row)] & kind_is_rough) != 0u;
    int any = 0;
#if TRAIT_SHIFT_DISTANCE
    const vec3 base = AT_V3(vertex, position, row);
    real reach = R(0);
#endif
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const uint neighbour = gradient_neighbour(slot, j, pixel, crop_width, crop_height);
        const size_t at = (size_t)j * capacity + row;
        const uint kind = AT_UINT(primary, kind, neighbour);
        AT_UINT(offset_vertex, kind, at) = kind;
        AT_UINT(offset_vertex, material, at) = AT_UINT(primary, material, neighbour);
        AT(offset_vertex, offset, at) = AT(primary, offset, neighbour);
        const vec3 position = AT_V3(primary, position, neighbour), wi = AT_V3(primary, wi, neighbour);
        const vec3 geometric = AT_V3(primary, geometric, neighbour);
        SET_V3(offset_vertex, position, at, position);
        SET_V3(offset_vertex, wi, at, wi);
        SET_V3(offset_vertex, geometric, at, geometric);
#if TRAIT_SHADING_NORMALS
        const vec3 shading = AT_V3(primary, shading, neighbour);
        SET_V3(offset_vertex, shading, at, shading);
#endif
#if TRAIT_ANISOTROPIC
        const vec3 along = AT_V3(primary, along, neighbour);
        SET_V3(offset_vertex, along, at, along);
#endif
        const int is_there = neighbour != slot, is_apart = is_there & (kind != kind_none);
        SET_RGB(shifted, value, at, rgb_gray(R(1)));
        AT(shifted, ratio, at) = is_there ? (is_apart ? R(1) : shift_failed(outcome_failed_at_once)) : shift_absent;
        SET_V3(shifted, wi, at, wi);
        AT_UINT(shifted, state, at) = shift_apart;
        any |= is_apart;
        all_rough &= (kind & kind_is_rough) != 0u || !is_apart;
#if TRAIT_SHIFT_DISTANCE
        reach = r_max(reach, is_apart ? reach_of(base, position, shift_distance) : R(0));
#endif
    }
    offset_state[row] = any ? (all_rough ? offset_rough : offset_mixed) : offset_none;
#if TRAIT_SHIFT_DISTANCE
    offset_reach[row] = reach;
#endif
}

/* Of later ones, rows `first` on, by the rays that `shift` sent out; base paths have rows index[escaped + first] on.
 * What hit nothing has failed, and what came from rough vertices, like its base path, to where both could reconnect:
 * there the shift back would. */
STAGE offset_surface(uint count, uint unit, uint first, uint escaped, uint capacity, __global const uint *index,
                     __global const real *ray, __global const real *offset_ray, uint offset_first, uint offset_stride,
                     __global real *shifted, __global real *offset_vertex, __global uint *offset_state,
                     __global const real *triangles, __global const real *triangle_normals,
                     __global const real *triangle_tangents, __global const real *spheres, uint triangle_count,
                     __global const uint *primitive_material, __global const uint *primitive_light,
                     __global const uint *material_back, __global const uint *material_kind
#if TRAIT_SHIFT_DISTANCE
                     ,
                     __global const real *vertex_old, __global const real *link, uint link_first, uint link_stride,
                     __global real *offset_reach, real shift_distance
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = first + i;
    const uint base = index[escaped + row];
    const uint base_primitive = AT_UINT(ray, primitive, base);
    int base_is_behind = 0;
#if TRAIT_TWO_FACED
    base_is_behind = primitive_is_behind(triangles, spheres, unit, triangle_count, base_primitive,
                                         AT_V3(ray, origin, base), AT_V3(ray, direction, base));
#endif
    const uint base_kind =
        kind_of_primitive(primitive_material, material_back, material_kind, base_primitive, base_is_behind);
    int all_rough = (base_kind & kind_is_rough) != 0u;
    int any = 0;
#if TRAIT_SHIFT_DISTANCE
    const vec3 base_before = AT_V3_IN(vertex_old, vertex, position, base);
    const vec3 base_position = primitive_hit_of(triangles, spheres, unit, triangle_count, base_primitive,
                                                AT_V3(ray, origin, base), AT_V3(ray, direction, base))
                                   .position;
    real reach = R(0);
#endif
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + row, sent = offset_first + (size_t)j * offset_stride + i;
        const uint state = AT_UINT(shifted, state, at);
        const real ratio = AT(shifted, ratio, at);
        const int was_apart = (ratio >= R(0)) & (state < shift_reconnected);
        const uint primitive = AT_UINT(offset_ray, primitive, sent);
        const int is_hit = primitive < ray_first_special;
        const uint present = is_hit ? primitive : 0u;
        const vec3 direction = AT_V3(offset_ray, direction, sent);
        const surface_point point =
            surface_point_of(triangles, triangle_normals, triangle_tangents, spheres, unit, triangle_count,
                             primitive_material, material_back, present, AT_V3(offset_ray, origin, sent), direction);
        const uint kind = material_kind[point.material];
        int would_reconnect = is_reconnectable(kind, primitive_light[present]);
#if TRAIT_SHIFT_DISTANCE
        const size_t segment = link_first + (size_t)j * link_stride + i;
        would_reconnect &=
            is_far(base_before, AT_V3(link, origin, segment), point.position, primitive_light[present], shift_distance);
#endif
        const int comes_back = (state != shift_apart_rough) | !would_reconnect;
        const int is_apart = was_apart & is_hit & comes_back;
        AT(shifted, ratio, at) =
            (was_apart & !is_apart) ? shift_failed(is_hit ? outcome_failed_back : outcome_failed_nothing) : ratio;
        AT_UINT(offset_vertex, kind, at) = is_apart ? kind : kind_none;
        AT_UINT(offset_vertex, material, at) = point.material;
        AT(offset_vertex, offset, at) = point.offset;
        SET_V3(offset_vertex, position, at, point.position);
        SET_V3(offset_vertex, wi, at, v3_neg(direction));
        SET_V3(offset_vertex, geometric, at, point.geometric);
#if TRAIT_SHADING_NORMALS
        SET_V3(offset_vertex, shading, at, point.shading);
#endif
#if TRAIT_ANISOTROPIC
        SET_V3(offset_vertex, along, at, point.along);
#endif
        any |= is_apart;
        all_rough &= (kind & kind_is_rough) != 0u || !is_apart;
#if TRAIT_SHIFT_DISTANCE
        reach = r_max(reach, is_apart ? reach_of(base_position, point.position, shift_distance) : R(0));
#endif
    }
    offset_state[row] = any ? (all_rough ? offset_rough : offset_mixed) : offset_none;
#if TRAIT_SHIFT_DISTANCE
    offset_reach[row] = reach;
#endif
}
