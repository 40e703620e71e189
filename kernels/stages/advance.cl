/* advance: offset paths follow their base paths, which have taken rows `to` on from places `first` on of the index:
 * their state moves to the new rows. Those that reconnected to what they do not see have failed; so have all that could
 * only end there: where the vertex is not rough, or met from another side (shift_ends).
 *
 * APART: some have vertices of their own, which their rays have met. */
//! traits: TRAIT_APART
#include "kernels/lib/surface_point.h"
#include "kernels/lib/surface_side.h"
#include "kernels/lib/textured_material.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/stage.h"

STAGE advance(uint count, uint unit, uint first, uint to, uint stride, uint capacity, __global const uint *index,
              __global const real *offset_old, __global real *offset, __global const real *link
#if SIDE_BY_SHADING
              ,
              __global const real *shift
#endif
#if TRAIT_APART
              ,
              __global const real *vertex
#endif
#if APART
              ,
              __global const real *offset_ray, __global real *offset_vertex, __global const real *triangles,
              __global const real *triangle_normals, __global const real *triangle_tangents,
              __global const real *spheres, uint triangle_count, __global const uint *primitive_material,
              __global const uint *material_back, __global const uint *material_kind SURFACE_ARGUMENT
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const int old = AT_INDEX(first + i);
    const size_t row = to + i;
#if TRAIT_APART
    const int is_rough = (AT_UINT(vertex, kind, row) & kind_is_rough) != 0u;
#endif
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const int from = (int)(j * capacity) + old;
        const size_t at = (size_t)j * capacity + row;
        const real ratio = AT_IN(offset_old, offset, ratio, from);
        const int open = AT_UINT(link, open, (int)((4u + j) * stride) + old) != 0u;
        int holds = open;
        uint reason = outcome_failed_kinds;
#if SIDE_BY_SHADING
        holds &= (AT_UINT(shift, outcome, from) & shift_ends) == 0u;
        reason = holds ? reason : outcome_failed_side;
#endif
#if TRAIT_APART
        const uint state = AT_UINT_IN(offset_old, offset, state, from);
        holds = (holds & is_rough) | (state != connection_recent);
        AT_UINT(offset, state, at) = state;
#endif
        const real failed = shift_failed(open ? reason : outcome_failed_hidden);
        AT(offset, ratio, at) = ratio < R(0) || holds ? ratio : failed;
        const rgb value = AT_RGB_IN(offset_old, offset, value, from);
        SET_RGB(offset, value, at, value);
        const vec3 wi = AT_V3_IN(offset_old, offset, wi, from);
        SET_V3(offset, wi, at, wi);
#if APART
        const int sent = (int)(j * stride) + old;
        const uint primitive = AT_UINT(offset_ray, primitive, sent);
        const int is_hit = primitive < ray_first_special;
        const vec3 direction = AT_V3(offset_ray, direction, sent);
        const surface_point point =
            CHOSEN_POINT(surface_point_of(triangles, triangle_normals, triangle_tangents, spheres, unit, triangle_count,
                                          primitive_material, material_back,
                                          is_hit ? primitive : 0u INSTANCE_IN(offset_ray, offset_ray, sent),
                                          AT_V3(offset_ray, origin, sent), direction),
                         4u * capacity, sent);
        const int is_own = is_hit & (ratio >= R(0)) & (state < connection_recent);
        SET_SURFACE_VERTEX(offset_vertex, at, is_own ? material_kind[point.material] : kind_none, point, direction)
        SET_VERTEX_TEXTURED(offset_vertex, at, 4u * capacity, sent)
#endif
    }
}
