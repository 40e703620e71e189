/* gradient_light: light sampling at the first two vertices of a base path and its offset paths: vertices of one BSDF
 * kind, rows `first` on. All go to the same light point. Leaves the connections, and what each path would gain with the
 * densities that weigh it (Kettunen et al. 2015, with four densities where both samplers shift alike): gradient_connect
 * adds it up once it is known who sees the light.
 *
 * FIRST: the offset paths are at their own first vertices, those of the neighbours' base paths. Else they have just
 * come to the base's second vertex, from another side. */
#include "kernels/lib/bsdf_any.h"
#include "kernels/lib/gradient.h"
#include "kernels/lib/light_sampling.h"
#include "kernels/lib/mis.h"

STAGE gradient_light(uint count, uint unit, uint first, uint capacity, uint slots, uint max_depth,
                     __global const real *vertex, __global const real *tangent, __global real *shadow,
                     __global real *gain, __global const real *materials, __global const real *lights,
                     __global const uint *light_kinds, __global const uint *light_alias, uint light_count,
                     real scene_diameter
#if FIRST
                     ,
                     __global real *link, uint link_first, uint link_stride, __global const real *primary, FILM_PLACE
#else
                     ,
                     __global const real *shifted
#endif
) {
    const size_t i = get_global_id(0);
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
    const real base_bsdf = PASTE(BSDF, _pdf)(m, wi, wo) * inverse_light_pdf;
    const rgb base = rgb_mul(rgb_mul(AT_RGB(vertex, throughput, row), arriving), PASTE(BSDF, _eval)(m, wi, wo));
    real any_offset = R(0);

#if FIRST
    const vec3 light_point = v3_add(position, s.connection);
    const int is_surface =
        IS_LIGHT(chosen, triangle, TRAIT_LIGHT_TRIANGLE) | IS_LIGHT(chosen, sphere, TRAIT_LIGHT_SPHERE);
    const int is_point = IS_LIGHT(chosen, point, TRAIT_LIGHT_POINT);
    const real base_distance_squared = v3_dot(s.connection, s.connection);
    const real base_cosine = -v3_dot(s.normal, s.direction);
    const real end_offset = FIELD_OF(light, lights, chosen.light, offset);
    const uint slot = AT_UINT(vertex, slot, row);
    const film_pixel pixel = PIXEL_OF(slot);
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const uint neighbour = gradient_neighbour(slot, j, pixel, crop_width, crop_height);
        const uint kind = AT_UINT(primary, kind, neighbour);
        const int is_there = kind != primary_none;
        const uint material_index = is_there ? AT_UINT(primary, material, neighbour) : 0u;
        const vec3 from = AT_V3(primary, position, neighbour);
        const vec3 to_point = v3_sub(light_point, from);
        const real point_distance_squared = r_max(v3_dot(to_point, to_point), R(1e-36));
        const vec3 to_point_unit = v3_scale(to_point, R(1) / r_sqrt(point_distance_squared));
        const int finite = is_surface || is_point;
        const vec3 direction = v3(finite ? to_point_unit.x : s.direction.x, finite ? to_point_unit.y : s.direction.y,
                                  finite ? to_point_unit.z : s.direction.z);
        const real cosine = -v3_dot(s.normal, direction);
        const real nearer = base_distance_squared / point_distance_squared;
        /* The Jacobian by solid angle; for a point light, which has none, the ratio of what arrives. */
        real jacobian = R(1);
        jacobian = is_point ? nearer : jacobian;
        jacobian = is_surface ? (cosine > R(0) && base_cosine > R(0) ? nearer * cosine / base_cosine : R(0)) : jacobian;
        /* The same point of the same light: chosen with the same density by area. Spheres are sampled by their cones.
         */
        real offset_light = jacobian > R(0) ? R(1) : R(0);
#if TRAIT_LIGHT_SPHERE
        const vec3 to_center = v3_sub(FIELD_V3(light, lights, chosen.light, p), from);
        const real sphere_pdf =
            light_sphere_pdf(FIELD_OF(light, lights, chosen.light, e1_x), FIELD_OF(light, lights, chosen.light, e1_y),
                             FIELD_OF(light, lights, chosen.light, inverse_area), v3_dot(to_center, to_center),
                             point_distance_squared, cosine);
        offset_light =
            IS_LIGHT(chosen, sphere, 1) ? (s.pdf > R(0) ? jacobian * sphere_pdf / s.pdf : R(0)) : offset_light;
#endif
        const material offset_material = material_load(materials, material_index, unit);
        const frame offset_axes = PRIMARY_FRAME(neighbour, offset_material);
        const bsdf_value f = bsdf_any(kind, offset_material, frame_to_local(offset_axes, AT_V3(primary, wi, neighbour)),
                                      frame_to_local(offset_axes, direction));
        const int is_rough = bsdf_is_rough(kind);
        const rgb value = rgb_scale(rgb_mul(arriving, f.value), is_rough ? jacobian : R(0));
        const size_t at = (size_t)j * capacity + row;
        SET_RGB(gain, value, at, value);
        AT(gain, base_bsdf, at) = base_bsdf;
        AT(gain, offset_light, at) = neighbour == slot ? shift_absent : is_rough ? offset_light : shift_failed;
        AT(gain, offset_bsdf, at) = f.pdf * jacobian * inverse_light_pdf;

        const vec3 origin =
            ray_origin(from, AT_V3(primary, geometric, neighbour), AT(primary, offset, neighbour), direction);
        const vec3 infinite = v3_add(from, s.connection);
        const vec3 end = v3(finite ? light_point.x : infinite.x, finite ? light_point.y : infinite.y,
                            finite ? light_point.z : infinite.z);
        const size_t segment = link_first + (size_t)j * link_stride + row;
        SET_V3(link, origin, segment, origin);
        SET_V3(link, direction, segment, v3_sub(v3_mad(end, end_offset, s.normal), origin));
        const int asks = neighbour != slot && rgb_max(value) > R(0);
        AT_UINT(link, open, segment) = asks ? 1u : 0u;
        any_offset = r_max(any_offset, asks ? base_bsdf : R(0));
    }
#else
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + row;
        const real ratio = AT(shifted, ratio, at);
        const vec3 offset_wi = frame_to_local(axes, AT_V3(shifted, wi, at));
        const int is_there = ratio >= R(0);
        const rgb value =
            rgb_scale(rgb_mul(rgb_mul(AT_RGB(shifted, value, at), arriving), PASTE(BSDF, _eval)(m, offset_wi, wo)),
                      is_there ? R(1) : R(0));
        SET_RGB(gain, value, at, value);
        AT(gain, base_bsdf, at) = base_bsdf;
        AT(gain, offset_light, at) = ratio;
        AT(gain, offset_bsdf, at) = r_max(ratio, R(0)) * PASTE(BSDF, _pdf)(m, offset_wi, wo) * inverse_light_pdf;
        any_offset = r_max(any_offset, rgb_max(value));
    }
#endif

    CONNECT_TO_LIGHT(row, position, chosen)
    SET_RGB(shadow, value, row, base);
    AT_UINT(shadow, open, row) = allowed && r_max(rgb_max(base), any_offset) > R(0) ? 1u : 0u;
}
