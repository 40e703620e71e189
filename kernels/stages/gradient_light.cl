/* gradient_light: light sampling at the first two vertices of a base path and its offset paths: vertices of one BSDF
 * kind, rows `first` on. All go to the same light point. Leaves the connections, and what each path would gain with the
 * densities that weigh it (Kettunen et al. 2015, with four densities where both samplers shift alike): gradient_connect
 * adds it up once it is known who sees the light.
 *
 * APART: offset paths may be at vertices of their own. JOINED: or have reconnected, and come to the base's vertex from
 * another side, or from the same. APART alone is for first vertices, where nothing has happened yet. Where a vertex of
 * their own is not rough, or the base's is not, the two samplers shift differently: each is then an integrand of its
 * own (gain_split), weighted by its share within each path. */
#include "kernels/lib/bsdf_any.h"
#include "kernels/lib/gradient.h"
#include "kernels/lib/light_sampling.h"
#include "kernels/lib/mis.h"

STAGE gradient_light(uint count, uint unit, uint first, uint capacity, uint slots, uint max_depth,
                     __global const real *vertex, __global const real *tangent, __global real *shadow,
                     __global real *gain, __global const real *materials, __global const real *lights,
                     __global const uint *light_kinds, __global const uint *light_alias, uint light_count,
                     real scene_diameter
#if APART
                     ,
                     __global real *link, uint link_first, uint link_stride, __global const real *LONE
#if !TRAIT_APART
                     ,
                     FILM_PLACE
#endif
#endif
#if JOINED || TRAIT_APART
                     ,
                     __global const real *shifted
#endif
#if APART && TRAIT_APART
                     ,
                     __global const uint *material_kind
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = first + i;
    const uint depth = AT_UINT(vertex, depth, row);
    const random4 u =
        random_draw(AT_UINT(vertex, key_0, row), AT_UINT(vertex, key_1, row), random_dimension_light(depth));
    const vec3 position = AT_V3(vertex, position, row);
    const chosen_light chosen =
        light_sampling(lights, light_kinds, light_alias, light_count, scene_diameter, unit, position, u);
    const light_choice s = chosen.choice;
    const int allowed = depth + 1u < max_depth;
    const rgb arriving = rgb_scale(s.value, allowed ? R(1) / chosen.probability : R(0));
    const real light_pdf = s.pdf * chosen.probability;
    /* Dirac lights have no density that BSDF sampling could match. */
    real inverse_light_pdf = light_pdf > R(0) ? R(1) / light_pdf : R(0);
#if STRATEGY == STRATEGY_LIGHT
    inverse_light_pdf = R(0);
#endif

    const material m = material_load(materials, AT_UINT(vertex, material, row), unit);
    const frame axes = VERTEX_FRAME(row, m);
    const vec3 wo = frame_to_local(axes, s.direction);
    const vec3 wi = frame_to_local(axes, AT_V3(vertex, wi, row));
    const bsdf_value base_f = PASTE(BSDF, _evaluate)(m, wi, wo, transport_radiance);
    const real base_bsdf = base_f.pdf * inverse_light_pdf;
    const rgb base = rgb_mul(rgb_mul(AT_RGB(vertex, throughput, row), arriving), base_f.value);
    real any_offset = R(0);
    AT(gain, base_bsdf, row) = base_bsdf;

#if APART
    const vec3 light_point = v3_add(position, s.connection);
    const int is_surface =
        IS_LIGHT(chosen, triangle, TRAIT_LIGHT_TRIANGLE) | IS_LIGHT(chosen, sphere, TRAIT_LIGHT_SPHERE);
    const int is_point = IS_LIGHT(chosen, point, TRAIT_LIGHT_POINT);
    const int is_finite_light = is_surface | is_point;
    const real base_distance_squared = v3_dot(s.connection, s.connection);
    const real base_cosine = -v3_dot(s.normal, s.direction);
    const real end_offset = FIELD_OF(light, lights, chosen.light, offset);
#if !TRAIT_APART
    const uint slot = AT_UINT(vertex, slot, row);
    const film_pixel pixel = PIXEL_OF(slot);
#endif
#endif
#if APART && TRAIT_APART
    const uint base_kind = material_kind[AT_UINT(vertex, material, row)];
#endif
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + row;
#if JOINED
        const real ratio = AT(shifted, ratio, at);
        const rgb so_far = AT_RGB(shifted, value, at);
        const vec3 joined_wi = frame_to_local(axes, AT_V3(shifted, wi, at));
        const bsdf_value joined_f = PASTE(BSDF, _evaluate)(m, joined_wi, wo, transport_radiance);
        /* Selected, not scaled: where there is no offset path, its direction is anything. */
        const int is_there = ratio >= R(0);
        const rgb joined_value = rgb_mul(rgb_mul(so_far, arriving), joined_f.value);
        rgb value =
            rgb3(is_there ? joined_value.r : R(0), is_there ? joined_value.g : R(0), is_there ? joined_value.b : R(0));
        real offset_light = ratio, offset_bsdf = is_there ? ratio * joined_f.pdf * inverse_light_pdf : R(0);
        real asks_base = rgb_max(value);
#endif
#if APART
#if JOINED
        const size_t from_row = LONE_ROW(j, row, 0u);
        const real ratio_before = ratio;
        const int is_apart = is_there & (AT_UINT(shifted, state, at) < shift_reconnected);
#elif TRAIT_APART
        const size_t from_row = LONE_ROW(j, row, 0u);
        const real ratio_before = AT(shifted, ratio, at);
        const rgb so_far = rgb_gray(R(1));
        const int is_apart = ratio_before >= R(0);
        rgb value = rgb_gray(R(0));
        real offset_light = ratio_before, offset_bsdf = R(0), asks_base = R(0);
#else
        const uint neighbour = gradient_neighbour(slot, j, pixel, crop_width, crop_height);
        const uint from_row = LONE_ROW(j, row, neighbour);
        const int is_apart = neighbour != slot;
#endif
        const uint kind = AT_UINT(LONE, kind, from_row);
        const vec3 from = AT_V3(LONE, position, from_row);
        const vec3 to_point = v3_sub(light_point, from);
        const real point_distance_squared = r_max(v3_dot(to_point, to_point), R(1e-36));
        const vec3 to_point_unit = v3_scale(to_point, R(1) / r_sqrt(point_distance_squared));
        const vec3 direction =
            v3(is_finite_light ? to_point_unit.x : s.direction.x, is_finite_light ? to_point_unit.y : s.direction.y,
               is_finite_light ? to_point_unit.z : s.direction.z);
        const real cosine = -v3_dot(s.normal, direction);
        const real nearer = base_distance_squared / point_distance_squared;
        /* The Jacobian by solid angle; for a point light, which has none, the ratio of what arrives. */
        real jacobian = R(1);
        jacobian = is_point ? nearer : jacobian;
        jacobian = is_surface ? (cosine > R(0) && base_cosine > R(0) ? nearer * cosine / base_cosine : R(0)) : jacobian;
        /* The same point of the same light, chosen with the same density by area. Spheres are sampled by cones. */
        real own_light = jacobian > R(0) ? R(1) : R(0);
#if TRAIT_LIGHT_SPHERE
        const vec3 to_center = v3_sub(FIELD_V3(light, lights, chosen.light, p), from);
        const real sphere_pdf =
            light_sphere_pdf(FIELD_OF(light, lights, chosen.light, e1_x), FIELD_OF(light, lights, chosen.light, e1_y),
                             FIELD_OF(light, lights, chosen.light, inverse_area), v3_dot(to_center, to_center),
                             point_distance_squared, cosine);
        own_light = IS_LIGHT(chosen, sphere, 1) ? (s.pdf > R(0) ? jacobian * sphere_pdf / s.pdf : R(0)) : own_light;
#endif
        const material own_material = material_load(materials, AT_UINT(LONE, material, from_row), unit);
        const frame own_axes = LONE_FRAME(from_row, own_material);
        const bsdf_value f = bsdf_any(kind, own_material, frame_to_local(own_axes, AT_V3(LONE, wi, from_row)),
                                      frame_to_local(own_axes, direction));
        const real own_bsdf = f.pdf * jacobian * inverse_light_pdf;
#if TRAIT_APART
        const int both_rough = (base_kind & kind & kind_is_rough) != 0u;
        const int scatters = (kind != kind_none) & ((kind & kind_is_dirac) == 0u);
        const real own_share = both_rough ? R(1) : R(1) / (R(1) + (own_light > R(0) ? own_bsdf / own_light : R(0)));
        const rgb own_value =
            rgb_scale(rgb_mul(rgb_mul(so_far, arriving), f.value), scatters ? jacobian * own_share : R(0));
        value =
            rgb3(is_apart ? own_value.r : value.r, is_apart ? own_value.g : value.g, is_apart ? own_value.b : value.b);
        offset_light =
            is_apart ? (scatters ? own_light * ratio_before : shift_failed(outcome_failed_kinds)) : offset_light;
        offset_bsdf = is_apart ? (both_rough ? own_bsdf * ratio_before : gain_split) : offset_bsdf;
        const int asks = is_apart & (rgb_max(value) > R(0));
        asks_base = is_apart ? (asks ? base_bsdf : R(0)) : asks_base;
#else
        const int is_rough = (kind & kind_is_rough) != 0u;
        const rgb value = rgb_scale(rgb_mul(arriving, f.value), is_rough ? jacobian : R(0));
        const real offset_light = is_apart ? (is_rough ? own_light : shift_failed(outcome_failed_kinds)) : shift_absent;
        const real offset_bsdf = own_bsdf;
        const int asks = is_apart & (rgb_max(value) > R(0));
        const real asks_base = asks ? base_bsdf : R(0);
#endif
        const vec3 origin = ray_origin(from, AT_V3(LONE, geometric, from_row), AT(LONE, offset, from_row), direction);
        const vec3 infinite = v3_add(from, s.connection);
        const vec3 end = v3(is_finite_light ? light_point.x : infinite.x, is_finite_light ? light_point.y : infinite.y,
                            is_finite_light ? light_point.z : infinite.z);
        const size_t segment = link_first + (size_t)j * link_stride + row;
        SET_V3(link, origin, segment, origin);
        SET_V3(link, direction, segment, v3_sub(v3_mad(end, end_offset, s.normal), origin));
        AT_UINT(link, open, segment) = asks ? 1u : 0u;
#endif
        SET_RGB(gain, value, at, value);
        AT(gain, offset_light, at) = offset_light;
        AT(gain, offset_bsdf, at) = offset_bsdf;
        any_offset = r_max(any_offset, asks_base);
    }

    CONNECT_TO_LIGHT(row, position, chosen)
    SET_RGB(shadow, value, row, base);
    AT_UINT(shadow, open, row) = allowed && r_max(rgb_max(base), any_offset) > R(0) ? 1u : 0u;
}
