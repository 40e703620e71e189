/* advance: the vertices that offset paths of their own have come to, which their rays have met; their base paths have
 * taken rows `to` on from places `first` on of the index. */
#include "kernels/lib/surface_point.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/stage.h"

STAGE advance(uint count, uint unit, uint first, uint to, uint stride, uint capacity, __global const uint *index,
              __global const real *offset_old, __global const real *offset_ray, __global real *offset_vertex,
              __global const real *triangles, __global const real *triangle_normals,
              __global const real *triangle_tangents, __global const real *spheres, uint triangle_count,
              __global const uint *primitive_material, __global const uint *material_back,
              __global const uint *material_kind) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const uint old = index[first + i];
    const size_t row = to + i;
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t from = (size_t)j * capacity + old, at = (size_t)j * capacity + row;
        const real ratio = AT_IN(offset_old, offset, ratio, from);
        const uint state = AT_UINT_IN(offset_old, offset, state, from);
        const size_t sent = (size_t)j * stride + old;
        const uint primitive = AT_UINT(offset_ray, primitive, sent);
        const int is_hit = primitive < ray_first_special;
        const vec3 direction = AT_V3(offset_ray, direction, sent);
        const surface_point point = surface_point_of(
            triangles, triangle_normals, triangle_tangents, spheres, unit, triangle_count, primitive_material,
            material_back, is_hit ? primitive : 0u, AT_V3(offset_ray, origin, sent), direction);
        const int is_own = is_hit & (ratio >= R(0)) & (state < connection_recent);
        SET_SURFACE_VERTEX(offset_vertex, at, is_own ? material_kind[point.material] : kind_none, point, direction)
    }
}
