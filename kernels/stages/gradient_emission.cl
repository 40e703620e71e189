/* gradient_emission: adds the light that a base path finds, at an emitting surface or (ESCAPED) the environment, to the
 * path and its differences: rows index[first] on, offset paths from `to` on. Offset paths that reconnected end in the
 * same point.
 *
 * APART: others may be elsewhere and find a light where the base path does not. Then light sampling would shift these
 * paths in another way, so each sampler is an integrand of its own, weighted by its share within each path. */
//! traits: TRAIT_LIGHT_TRIANGLE TRAIT_LIGHT_SPHERE TRAIT_APART
#include "kernels/lib/light_found.h"
#include "kernels/lib/mis.h"
#include "kernels/lib/weighted_difference.h"
#include "kernels/shared/stage.h"

STAGE gradient_emission(uint count, uint unit, uint first, uint to, uint capacity, uint slots,
                        __global const uint *index, __global const real *ray, __global const real *vertex_old,
                        __global const real *shifted, __global const real *link, uint link_first, uint link_stride,
                        __global real *prefix, __global real *difference, __global const real *triangles,
                        __global const real *spheres, uint triangle_count, __global const uint *primitive_light,
                        __global const real *lights, uint light_count, uint environment_light
#if TRAIT_APART
                        ,
                        __global const real *shifted_old
#endif
#if APART
                        ,
                        __global const real *offset_ray, uint offset_first, uint offset_stride
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const uint row = index[first + i];
    const uint slot = AT_UINT_IN(vertex_old, vertex, slot, row);
    const real bsdf_pdf = AT_IN(vertex_old, vertex, pdf, row);
    const rgb throughput = AT_RGB_IN(vertex_old, vertex, throughput, row);
#if ESCAPED
    light_found found;
    found.radiance = FIELD_RGB(light, lights, environment_light, value);
    found.pdf = FIELD_OF(light, lights, environment_light, probability) * (R(0.25) * GRADUS_INV_PI);
#else
    const uint primitive = AT_UINT(ray, primitive, row);
    const vec3 origin = AT_V3(ray, origin, row), direction = AT_V3(ray, direction, row);
    const primitive_hit hit = primitive_hit_of(triangles, spheres, unit, triangle_count, primitive, origin, direction);
    const light_found found =
        light_found_at(primitive_light, lights, light_count, unit, triangle_count, primitive, hit, origin, direction);
#endif
    /* Densities over that of BSDF sampling; a Dirac direction cannot be found by light sampling. */
    real base_light = bsdf_pdf > R(0) ? found.pdf / bsdf_pdf : R(0);
#if STRATEGY == STRATEGY_BSDF
    base_light = R(0);
#endif
    rgb radiance = found.radiance;
#if STRATEGY == STRATEGY_LIGHT
    radiance = rgb_scale(radiance, bsdf_pdf > R(0) ? R(0) : R(1));
    base_light = R(0);
#endif
    const rgb base = rgb_mul(throughput, radiance);
    const rgb alone = rgb_scale(base, R(1) / (R(1) + base_light));
    ADD_RGB(prefix, value, slot, alone);
#if !ESCAPED && TRAIT_LIGHT_SPHERE
    const vec3 base_connection = v3_sub(hit.position, origin);
    const real base_distance_squared = v3_dot(base_connection, base_connection);
    const real base_cosine = -v3_dot(hit.normal, direction);
#endif
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + to + i, to_slot = (size_t)j * slots + slot;
        const size_t segment = link_first + (size_t)j * link_stride + i;
        const real ratio = AT(shifted, ratio, at);
        const rgb so_far = AT_RGB(shifted, value, at);
        int is_open = AT_UINT(link, open, segment) != 0u;
        /* The same point by area: the Jacobian turns one density by solid angle into the other. */
        real offset_light = base_light;
#if !ESCAPED && TRAIT_LIGHT_SPHERE
        const vec3 from = AT_V3(link, origin, segment);
        const vec3 connection = v3_sub(hit.position, from);
        const real distance_squared = r_max(v3_dot(connection, connection), R(1e-36));
        const real cosine = -v3_dot(hit.normal, connection) / r_sqrt(distance_squared);
        const light_found from_offset =
            light_found_at(primitive_light, lights, light_count, unit, triangle_count, primitive, hit, from,
                           v3_scale(connection, R(1) / r_sqrt(distance_squared)));
        const real jacobian =
            base_cosine > R(0) ? r_max(cosine, R(0)) / base_cosine * base_distance_squared / distance_squared : R(0);
        offset_light = base_light > R(0) ? jacobian * from_offset.pdf / bsdf_pdf : R(0);
#endif
#if TRAIT_APART
        const uint state = AT_UINT(shifted, state, at);
        const int is_merged = state == shift_merged;
        is_open |= is_merged;
        offset_light = is_merged ? base_light : offset_light;
        offset_light *= r_max(AT_IN(shifted_old, shifted, ratio, (size_t)j * capacity + row), R(0));
#endif
        const real open = is_open ? R(1) : R(0);
        rgb offset = rgb_scale(rgb_mul(so_far, radiance), open);
        rgb mine = base;
        real mine_other = base_light, density = offset_light + open * ratio, marker = ratio;
#if APART
        const int is_apart = state < shift_reconnected;
        const real offset_pdf = AT(shifted, pdf, at);
        const size_t sent = offset_first + (size_t)j * offset_stride + i;
        const uint offset_primitive = AT_UINT(offset_ray, primitive, sent);
#if ESCAPED
        const light_found own = found;
        marker =
            is_apart && offset_primitive != ray_escaped ? r_min(ratio, shift_failed(outcome_failed_nothing)) : ratio;
#else
        const uint present = offset_primitive < ray_first_special ? offset_primitive : 0u;
        const vec3 own_origin = AT_V3(offset_ray, origin, sent), own_direction = AT_V3(offset_ray, direction, sent);
        const light_found own = light_found_at(
            primitive_light, lights, light_count, unit, triangle_count, present,
            primitive_hit_of(triangles, spheres, unit, triangle_count, present, own_origin, own_direction), own_origin,
            own_direction);
#endif
        real own_light = offset_pdf > R(0) ? own.pdf / offset_pdf : R(0);
        real own_share = R(1);
#if STRATEGY == STRATEGY_BSDF
        own_light = R(0);
#endif
#if STRATEGY == STRATEGY_LIGHT
        own_light = R(0);
        own_share = offset_pdf > R(0) ? R(0) : R(1);
#endif
        const rgb own_value = rgb_scale(rgb_mul(so_far, own.radiance), own_share / (R(1) + own_light));
        offset = rgb3(is_apart ? own_value.r : offset.r, is_apart ? own_value.g : offset.g,
                      is_apart ? own_value.b : offset.b);
        mine = rgb3(is_apart ? alone.r : base.r, is_apart ? alone.g : base.g, is_apart ? alone.b : base.b);
        mine_other = is_apart ? R(0) : base_light;
        density = is_apart ? ratio : density;
#endif
        const rgb change = weighted_difference(mine, offset, mine_other, density, marker);
        ADD_RGB(difference, value, to_slot, change);
    }
}
