/* shift: takes the offset paths of a base path one vertex further: rows index[first] on. Those that may reconnect to
 * the base's new vertex, or where that is at infinity (ESCAPED) go in the same direction, and ask whether the way is
 * free (`link`). Leaves them in `shifted`, rows `to` on. Runs before `surface`, on the old vertices.
 *
 * APART: others copy the half vector and send out a ray of their own (`offset_ray`). Where that is not compiled, all
 * that are apart may reconnect. Which of both is done is a matter of the two vertices and the base's next one, so that
 * the shift back does the same; `offset_surface` makes sure of the fourth.
 *
 * The shift fails where the neighbour saw nothing, where the new vertex would be seen from its other side, between a
 * Dirac kind and one that is none, and where the half-vector copy does (kernels/lib/shift_half_vector.h,
 * shift_specular.h). */
//! traits: TRAIT_SHIFT_DISTANCE
#include "kernels/lib/bsdf_any.h"
#include "kernels/lib/gradient.h"
#include "kernels/lib/reconnectable.h"
#include "kernels/lib/scene_hit.h"
#include "kernels/lib/shift_reconnection.h"
#include "kernels/lib/shift_specular.h"

STAGE shift(uint count, uint unit, uint first, uint to, uint capacity, uint slots, __global const uint *index,
            __global const real *ray, __global const real *vertex, __global real *shifted, __global real *link,
            uint link_first, uint link_stride, __global const real *LONE, __global const real *materials,
            __global const real *triangles, __global const real *spheres, uint triangle_count, real scene_diameter
#if TRAIT_APART
            ,
            __global const real *shifted_old
#else
            ,
            FILM_PLACE
#endif
#if APART
            ,
            __global const real *tangent, __global const uint *primitive_material, __global const uint *primitive_light,
            __global const uint *material_back, __global const uint *material_kind, __global real *offset_ray,
            uint offset_first, uint offset_stride
#if TRAIT_SHIFT_DISTANCE
            ,
            real shift_distance
#endif
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const uint row = index[first + i];
    const real pdf = AT(vertex, pdf, row);
    const vec3 base = AT_V3(vertex, position, row);
    const vec3 base_direction = AT_V3(ray, direction, row);
#if !ESCAPED
    const uint primitive = AT_UINT(ray, primitive, row);
    const primitive_hit hit =
        primitive_hit_of(triangles, spheres, unit, triangle_count, primitive, AT_V3(ray, origin, row), base_direction);
    const real base_side = v3_dot(hit.normal, v3_sub(base, hit.position));
    const real offset = primitive_offset(triangles, spheres, unit, triangle_count, primitive);
    const vec3 end = v3_mad(hit.position, offset * r_copysign1(base_side), hit.normal);
#endif
#if APART
    const uint base_material_index = AT_UINT(vertex, material, row);
    const uint base_kind = material_kind[base_material_index];
    const int base_is_rough = (base_kind & kind_is_rough) != 0u, base_is_dirac = (base_kind & kind_is_dirac) != 0u;
    const material base_material = material_load(materials, base_material_index, unit);
    const frame base_axes = VERTEX_FRAME(row, base_material);
    const vec3 base_wi = frame_to_local(base_axes, AT_V3(vertex, wi, row));
    const vec3 base_wo = frame_to_local(base_axes, base_direction);
    const int is_reflected = base_wi.z * base_wo.z > R(0);
    const real probability = bsdf_any_dirac(base_kind, base_material, base_wi, is_reflected).pdf;
    const real base_pdf = base_is_dirac ? probability : pdf;
#if ESCAPED
    const int reconnectable = 1;
#else
    const uint next_kind =
        kind_of_primitive(primitive_material, material_back, material_kind, primitive, base_side < R(0));
    const int reconnectable = is_reconnectable(next_kind, primitive_light[primitive]);
#endif
#else
    const real base_pdf = pdf;
#endif
    const real inverse_pdf = base_pdf > R(0) ? R(1) / base_pdf : R(0);
#if !TRAIT_APART
    const uint slot = AT_UINT(vertex, slot, row);
    const film_pixel pixel = PIXEL_OF(slot);
#endif
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + to + i;
#if TRAIT_APART
        const size_t from_row = LONE_ROW(j, row, 0u);
        const real ratio_before = AT_IN(shifted_old, shifted, ratio, from_row);
        const rgb value_before = AT_RGB_IN(shifted_old, shifted, value, from_row);
        const int is_there = ratio_before >= R(0);
        const int is_apart = is_there & (AT_UINT_IN(shifted_old, shifted, state, from_row) < shift_reconnected);
#else
        const uint neighbour = gradient_neighbour(slot, j, pixel, crop_width, crop_height);
        const uint from_row = LONE_ROW(j, row, neighbour);
        const real ratio_before = neighbour == slot ? shift_absent : R(1);
        const rgb value_before = rgb_gray(R(1));
        const int is_there = neighbour != slot, is_apart = is_there;
#endif
        const uint kind = AT_UINT(LONE, kind, from_row);
        const int is_rough = (kind & kind_is_rough) != 0u;
        const vec3 from = AT_V3(LONE, position, from_row);
#if ESCAPED
        const vec3 to_next = base_direction;
        const real reconnection = R(1);
        const int same_side = 1;
#else
        const vec3 connection = v3_sub(hit.position, from);
        const vec3 to_next = v3_normalize(connection);
        const real reconnection = reconnection_jacobian(base, from, hit.position, hit.normal);
        const int same_side = -v3_dot(hit.normal, connection) * base_side > R(0);
#endif
        const material m = material_load(materials, AT_UINT(LONE, material, from_row), unit);
        const frame axes = LONE_FRAME(from_row, m);
        const vec3 wi = frame_to_local(axes, AT_V3(LONE, wi, from_row));
#if APART
        const int both_rough = base_is_rough & is_rough;
#if TRAIT_SHIFT_DISTANCE && !ESCAPED
        const int is_long = is_far(base, from, hit.position, primitive_light[primitive], shift_distance);
#else
        const int is_long = 1;
#endif
        const int reconnects = both_rough & reconnectable & is_long;
        const int is_dirac = (kind & kind_is_dirac) != 0u;
        const int alike = (kind != kind_none) & (is_dirac == base_is_dirac);
        const real ior = kind_number(kind) == bsdf_kind_null ? R(1) : m.ior;
        const shifted_direction mirrored = shift_specular(base_wi, base_wo, wi, ior);
        const shifted_direction copied = shift_half_vector(base_wi, base_wo, base_material.ior, wi, ior);
        const vec3 wo_copied = v3(is_dirac ? mirrored.wo.x : copied.wo.x, is_dirac ? mirrored.wo.y : copied.wo.y,
                                  is_dirac ? mirrored.wo.z : copied.wo.z);
        const int copy_is_valid = alike & (is_dirac ? mirrored.is_valid : copied.is_valid);
        const real copy_jacobian = is_dirac ? mirrored.jacobian : copied.jacobian;
        const vec3 own = frame_to_world(axes, wo_copied);
        const vec3 own_unit = v3_scale(own, R(1) / r_max(r_sqrt(v3_dot(own, own)), R(1e-15)));
        const vec3 direction = v3(reconnects ? to_next.x : own_unit.x, reconnects ? to_next.y : own_unit.y,
                                  reconnects ? to_next.z : own_unit.z);
        const real jacobian = reconnects ? reconnection : copy_jacobian;
        const bsdf_value rough = bsdf_any(kind, m, wi, frame_to_local(axes, direction));
        const bsdf_value dirac = bsdf_any_dirac(kind, m, wi, is_reflected);
        const rgb f = rgb3(is_dirac ? dirac.value.r : rough.value.r, is_dirac ? dirac.value.g : rough.value.g,
                           is_dirac ? dirac.value.b : rough.value.b);
        const real offset_pdf = is_dirac ? dirac.pdf : rough.pdf;
        const int copies = copy_is_valid & (offset_pdf > R(0));
        const int works = (base_pdf > R(0)) & (reconnects ? same_side & (reconnection > R(0)) : copies);
#else
        const int reconnects = 1;
        const vec3 direction = to_next;
        const real jacobian = reconnection;
        const bsdf_value f_rough = bsdf_any(kind, m, wi, frame_to_local(axes, direction));
        const rgb f = f_rough.value;
        const real offset_pdf = f_rough.pdf;
        const int works = (base_pdf > R(0)) & is_rough & same_side & (reconnection > R(0));
#endif
#if APART
        const uint reason = reconnects ? outcome_failed_side : alike ? outcome_failed_copy : outcome_failed_kinds;
#else
        const uint reason = kind == kind_none ? outcome_failed_at_once : outcome_failed_side;
#endif
        const real factor = works ? jacobian * inverse_pdf : R(0);
        const rgb value = rgb_mul(value_before, rgb_scale(f, factor));
        const real ratio = works ? ratio_before * offset_pdf * factor : shift_failed(reason);
        /* Others stay what they are. A direction that could not be copied may have no value: selected, not scaled. */
        SET_RGB(shifted, value, at,
                rgb3(is_apart ? (works ? value.r : R(0)) : value_before.r,
                     is_apart ? (works ? value.g : R(0)) : value_before.g,
                     is_apart ? (works ? value.b : R(0)) : value_before.b));
        AT(shifted, ratio, at) = is_apart ? ratio : ratio_before;
        const vec3 last = v3(is_apart ? direction.x : base_direction.x, is_apart ? direction.y : base_direction.y,
                             is_apart ? direction.z : base_direction.z);
        SET_V3(shifted, wi, at, v3_neg(last));

        const vec3 origin = ray_origin(from, AT_V3(LONE, geometric, from_row), AT(LONE, offset, from_row), direction);
        const size_t segment = link_first + (size_t)j * link_stride + i;
#if APART && TRAIT_SHIFT_DISTANCE
        /* Where nothing is asked, `offset_surface` asks which vertex this was. */
        SET_V3(link, origin, segment,
               v3(reconnects ? origin.x : from.x, reconnects ? origin.y : from.y, reconnects ? origin.z : from.z));
#else
        SET_V3(link, origin, segment, origin);
#endif
#if ESCAPED
        SET_V3(link, direction, segment, v3_scale(direction, scene_diameter));
#else
        SET_V3(link, direction, segment, v3_sub(end, origin));
#endif
        AT_UINT(link, open, segment) = (is_apart & reconnects & works & (offset_pdf > R(0))) ? 1u : 0u;
#if TRAIT_APART
        uint state = is_apart ? shift_reconnected : shift_merged;
#if APART
        state = (is_apart & !reconnects) ? (both_rough ? shift_apart_rough : shift_apart) : state;
        AT(shifted, pdf, at) = is_dirac ? R(0) : offset_pdf;
        const size_t sent = offset_first + (size_t)j * offset_stride + i;
        SET_V3(offset_ray, origin, sent, origin);
        SET_V3(offset_ray, direction, sent, direction);
        AT_UINT(offset_ray, primitive, sent) = (is_apart & !reconnects & works) ? ray_pending : ray_none;
#endif
        AT_UINT(shifted, state, at) = state;
#endif
    }
}
