/* gradient_emission: adds the light that a base path finds at its second vertex, an emitting surface or (ESCAPED) the
 * environment, to the path and its differences: rows index[first] on, offset paths from `to` on. */
//! traits: TRAIT_LIGHT_TRIANGLE TRAIT_LIGHT_SPHERE
#include "kernels/lib/gradient.h"
#include "kernels/lib/light.h"
#include "kernels/lib/mis.h"
#include "kernels/lib/scene_hit.h"
#include "kernels/lib/weighted_difference.h"

STAGE gradient_emission(uint count, uint unit, uint first, uint to, uint capacity, uint slots,
                        __global const uint *index, __global const real *ray, __global const real *vertex_old,
                        __global const real *shifted, __global const real *link, uint link_first, uint link_stride,
                        __global real *prefix, __global real *difference, __global const real *primary,
                        __global const real *triangles, __global const real *spheres, uint triangle_count,
                        __global const uint *primitive_light, __global const real *lights, uint environment_light,
                        FILM_PLACE) {
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
    const uint row = index[first + i];
    const uint slot = AT_UINT_IN(vertex_old, vertex, slot, row);
    const real bsdf_pdf = AT_IN(vertex_old, vertex, pdf, row);
    const rgb throughput =
        rgb3(AT_IN(vertex_old, vertex, throughput_r, row), AT_IN(vertex_old, vertex, throughput_g, row),
             AT_IN(vertex_old, vertex, throughput_b, row));
#if ESCAPED
    const uint light = environment_light;
    const real probability = FIELD_OF(light, lights, light, probability);
    real light_pdf = probability * (R(0.25) * GRADUS_INV_PI);
    const real seen = R(1);
#else
    const uint primitive = AT_UINT(ray, primitive, row);
    const vec3 origin = AT_V3(ray, origin, row), direction = AT_V3(ray, direction, row);
    const primitive_hit hit = primitive_hit_of(triangles, spheres, unit, triangle_count, primitive, origin, direction);
    const real side = -v3_dot(hit.normal, direction);
    const real seen = side > R(0) ? R(1) : R(0);
    const vec3 connection = v3_sub(hit.position, origin);
    const real distance_squared = v3_dot(connection, connection);
    const uint light = primitive_light[primitive];
    const real probability = FIELD_OF(light, lights, light, probability);
    const real inverse_area = FIELD_OF(light, lights, light, inverse_area);
    real light_pdf = light_area_pdf(inverse_area, distance_squared, side) * probability;
    const int is_sphere = TRAIT_LIGHT_SPHERE && (!TRAIT_LIGHT_TRIANGLE || primitive >= triangle_count);
#if TRAIT_LIGHT_SPHERE
    const vec3 center = FIELD_V3(light, lights, light, p);
    const real radius = FIELD_OF(light, lights, light, e1_x), facing = FIELD_OF(light, lights, light, e1_y);
    const vec3 to_center = v3_sub(center, origin);
    const real sphere_pdf =
        light_sphere_pdf(radius, facing, inverse_area, v3_dot(to_center, to_center), distance_squared, side);
    light_pdf = is_sphere ? sphere_pdf * probability : light_pdf;
#endif
#endif
    /* Densities over that of BSDF sampling; a Dirac direction cannot be found by light sampling. */
    real base_light = bsdf_pdf > R(0) ? light_pdf / bsdf_pdf : R(0);
#if STRATEGY == STRATEGY_BSDF
    base_light = R(0);
#endif
    rgb radiance = rgb_scale(rgb3(FIELD_OF(light, lights, light, value_r), FIELD_OF(light, lights, light, value_g),
                                  FIELD_OF(light, lights, light, value_b)),
                             seen);
#if STRATEGY == STRATEGY_LIGHT
    radiance = rgb_scale(radiance, bsdf_pdf > R(0) ? R(0) : R(1));
    base_light = R(0);
#endif
    const rgb base = rgb_mul(throughput, radiance);
    const rgb alone = rgb_scale(base, R(1) / (R(1) + base_light));
    ADD_RGB(prefix, value, slot, alone);
#if !ESCAPED && TRAIT_LIGHT_SPHERE
    const film_pixel pixel = PIXEL_OF(slot);
#endif
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + to + i;
        const real ratio = AT(shifted, ratio, at);
        const real open = AT_UINT(link, open, link_first + (size_t)j * link_stride + i) ? R(1) : R(0);
        const rgb offset = rgb_scale(rgb_mul(AT_RGB(shifted, value, at), radiance), open);
        /* The same point by area: the Jacobian turns one density by solid angle into the other. */
        real offset_light = base_light;
#if !ESCAPED && TRAIT_LIGHT_SPHERE
        const uint neighbour = gradient_neighbour(slot, j, pixel, crop_width, crop_height);
        const vec3 from = AT_V3(primary, position, neighbour);
        const vec3 offset_connection = v3_sub(hit.position, from), offset_to_center = v3_sub(center, from);
        const real offset_distance_squared = r_max(v3_dot(offset_connection, offset_connection), R(1e-36));
        const real cosine = -v3_dot(hit.normal, offset_connection) / r_sqrt(offset_distance_squared);
        const real offset_pdf = light_sphere_pdf(
            radius, facing, inverse_area, v3_dot(offset_to_center, offset_to_center), offset_distance_squared, cosine);
        const real jacobian =
            side > R(0) ? r_max(cosine, R(0)) / side * distance_squared / offset_distance_squared : R(0);
        offset_light = is_sphere && base_light > R(0) ? jacobian * offset_pdf * probability / bsdf_pdf : offset_light;
#endif
        const rgb change = weighted_difference(base, offset, base_light, offset_light + open * ratio, ratio);
        const size_t to_slot = (size_t)j * slots + slot;
        ADD_RGB(difference, value, to_slot, change);
    }
}
