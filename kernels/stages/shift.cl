/* shift: reconnects the offset paths of first vertices to the second vertex of the base path, or sends them in the same
 * direction to infinity (ESCAPED): rows index[first] on. Leaves the offset paths in `shifted`, rows `to` on, and the
 * segments that must be free. Runs before `surface`, on the old vertices.
 *
 * The shift fails where a first vertex is of a Dirac kind, where the neighbour saw nothing, where the second vertex
 * would be seen from its other side. */
#include "kernels/lib/bsdf_any.h"
#include "kernels/lib/gradient.h"
#include "kernels/lib/scene_hit.h"
#include "kernels/lib/shift_reconnection.h"

STAGE shift(uint count, uint unit, uint first, uint to, uint capacity, uint slots, __global const uint *index,
            __global const real *ray, __global const real *vertex_old, __global real *shifted, __global real *link,
            uint link_first, uint link_stride, __global const real *primary, __global const real *materials,
            __global const real *triangles, __global const real *spheres, uint triangle_count, real scene_diameter,
            FILM_PLACE) {
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
    const uint row = index[first + i];
    const uint slot = AT_UINT_IN(vertex_old, vertex, slot, row);
    const real pdf = AT_IN(vertex_old, vertex, pdf, row);
    const real inverse_pdf = pdf > R(0) ? R(1) / pdf : R(0);
    const vec3 base = v3(AT_IN(vertex_old, vertex, position_x, row), AT_IN(vertex_old, vertex, position_y, row),
                         AT_IN(vertex_old, vertex, position_z, row));
    const vec3 base_direction = AT_V3(ray, direction, row);
#if !ESCAPED
    const uint primitive = AT_UINT(ray, primitive, row);
    const primitive_hit hit =
        primitive_hit_of(triangles, spheres, unit, triangle_count, primitive, AT_V3(ray, origin, row), base_direction);
    const real base_side = v3_dot(hit.normal, v3_sub(base, hit.position));
    const real offset = primitive_offset(triangles, spheres, unit, triangle_count, primitive);
    const vec3 end = v3_mad(hit.position, offset * r_copysign1(base_side), hit.normal);
#endif
    const film_pixel pixel = PIXEL_OF(slot);
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const uint neighbour = gradient_neighbour(slot, j, pixel, crop_width, crop_height);
        const uint kind = AT_UINT(primary, kind, neighbour);
        const uint material_index = kind != primary_none ? AT_UINT(primary, material, neighbour) : 0u;
        const vec3 from = AT_V3(primary, position, neighbour);
#if ESCAPED
        const vec3 direction = base_direction;
        const real jacobian = R(1);
        const int same_side = 1;
#else
        const vec3 connection = v3_sub(hit.position, from);
        const vec3 direction = v3_normalize(connection);
        const real jacobian = reconnection_jacobian(base, from, hit.position, hit.normal);
        const int same_side = -v3_dot(hit.normal, connection) * base_side > R(0);
#endif
        const material m = material_load(materials, material_index, unit);
        const frame axes = PRIMARY_FRAME(neighbour, m);
        const bsdf_value f =
            bsdf_any(kind, m, frame_to_local(axes, AT_V3(primary, wi, neighbour)), frame_to_local(axes, direction));
        const int works = pdf > R(0) && bsdf_is_rough(kind) && same_side && jacobian > R(0);
        const real factor = works ? jacobian * inverse_pdf : R(0);
        const size_t at = (size_t)j * capacity + to + i;
        SET_RGB(shifted, value, at, rgb_scale(f.value, factor));
        AT(shifted, ratio, at) = neighbour == slot ? shift_absent : works ? f.pdf * factor : shift_failed;
        SET_V3(shifted, wi, at, v3_neg(direction));

        const vec3 origin =
            ray_origin(from, AT_V3(primary, geometric, neighbour), AT(primary, offset, neighbour), direction);
        const size_t segment = link_first + (size_t)j * link_stride + i;
        SET_V3(link, origin, segment, origin);
#if ESCAPED
        SET_V3(link, direction, segment, v3_scale(direction, scene_diameter));
#else
        SET_V3(link, direction, segment, v3_sub(end, origin));
#endif
        AT_UINT(link, open, segment) = neighbour != slot && works && f.pdf > R(0) ? 1u : 0u;
    }
}
