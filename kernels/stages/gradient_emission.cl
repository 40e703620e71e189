/* gradient_emission: adds the light that a base path finds, at an emitting surface or (ESCAPED) the environment, to the
 * path and its differences, where offset paths have stepped with it: rows index[first] on. Offset paths that
 * reconnected end in the same point.
 *
 * TRAIT_APART: others may be elsewhere and find a light where the base path does not. Then light sampling would shift
 * these paths in another way, so each sampler is an integrand of its own, weighted by its share within each path. */
//! traits: TRAIT_LIGHT_TRIANGLE TRAIT_LIGHT_SPHERE TRAIT_LIGHT_TREE TRAIT_APART
#include "kernels/lib/escaped_light.h"
#include "kernels/lib/light_tree.h"
#include "kernels/lib/mis.h"
#include "kernels/lib/weighted_difference.h"
#include "kernels/shared/stage.h"

/* Whether base and offset vertices would choose the light with probabilities of their own. */
#if TRAIT_LIGHT_TREE && !ESCAPED
#define OWN_CHOICE 1
#define RECEIVER_OF(j, before)                                                                                         \
    LIGHT_RECEIVER(AT_V3(link, origin, (int)((4u + (j)) * stride) + row),                                              \
                   AT_UINT(shift, receiver, (int)((j)*capacity) + row), receivers.before.normal.z)
#else
#define OWN_CHOICE 0
#endif

STAGE gradient_emission(uint count, uint unit, uint first, uint stride, uint capacity, uint slots,
                        __global const uint *index, __global const real *path, __global const real *offset,
                        __global const real *link, __global real *prefix, __global real *difference,
                        __global const real *lights
#if ESCAPED
                        ,
                        uint environment_light ENVIRONMENT_PARAMETERS
#if TRAIT_LIGHT_ENVIRONMENT
                        ,
                        __global const real *ray
#endif
#else
                        ,
                        __global const real *ray, __global const real *triangles, __global const real *spheres,
                        uint triangle_count, __global const uint *primitive_light,
                        uint light_count LIGHT_TEXTURE_PARAMETERS LIGHT_PROBABILITY_PARAMETERS
#endif
#if TRAIT_APART || OWN_CHOICE
                        ,
                        __global const real *shift
#endif
#if TRAIT_APART
                        ,
                        __global const real *offset_ray
#endif
) {
    const size_t i = work_item();
    uint kept = 0u;
#if ESCAPED && TRAIT_LIGHT_ENVIRONMENT
    kept = ESCAPED_BITS(environment_light);
#elif !ESCAPED && LIGHTS_HAVE_SURFACE_TEXTURES
    kept = texture_bits(TRAIT_LIGHT_TEXTURES, 0u, textures, texture_reals, unit);
#endif
    if (!HAS_ROW(i, count, kept))
        return;
    const int row = AT_INDEX(first + i);
    const int slot = AT_ROW(path, slot, row);
    const real bsdf_pdf = AT(path, pdf, row);
    const rgb throughput = AT_RGB(path, throughput, row);
#if ESCAPED
    vec3 direction = v3(R(0), R(0), R(1));
#if TRAIT_LIGHT_ENVIRONMENT
    direction = AT_V3(ray, direction, row);
#endif
    const light_found found = light_escaped(lights, environment_light, unit, direction ENVIRONMENT_ARGUMENTS);
#else
    const uint primitive = AT_UINT(ray, primitive, row);
    const vec3 origin = AT_V3(ray, origin, row), direction = AT_V3(ray, direction, row);
    const primitive_hit hit = primitive_hit_of(triangles, spheres, unit, triangle_count,
                                               primitive INSTANCE_IN(ray, ray, row), origin, direction);
    light_found found = light_found_at(primitive_light, lights, light_count, unit, triangle_count, primitive, hit,
                                       origin, direction LIGHT_TEXTURE_ARGUMENTS);
#if OWN_CHOICE
    light_receivers receivers;
    receivers.base = LIGHT_RECEIVER(origin, AT_UINT(path, receiver, row), R(0));
    receivers.offset_0 = RECEIVER_OF(0u, base);
    receivers.offset_1 = RECEIVER_OF(1u, offset_0);
    receivers.offset_2 = RECEIVER_OF(2u, offset_1);
    receivers.offset_3 = RECEIVER_OF(3u, offset_2);
    const light_paths ways =
        light_tree_paths(light_nodes, TRAIT_LIGHT_TREE, unit, light_leaf[(int)found.light], receivers, 1, R(1), 1);
    found.pdf *= ways.base;
#endif
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
        const int at = (int)(j * capacity) + row, to_slot = (int)(j * slots) + slot;
        const int segment = (int)((4u + j) * stride) + row;
        const real ratio = AT(offset, ratio, at);
        const rgb so_far = AT_RGB(offset, value, at);
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
                           v3_scale(connection, R(1) / r_sqrt(distance_squared)) LIGHT_TEXTURE_ARGUMENTS);
        const real jacobian =
            base_cosine > R(0) ? r_max(cosine, R(0)) / base_cosine * base_distance_squared / distance_squared : R(0);
        real there = jacobian * from_offset.pdf;
#if OWN_CHOICE
        there *= ways.base * LIGHT_PATH_OF(ways, j);
#endif
        offset_light = base_light > R(0) ? there / bsdf_pdf : R(0);
#elif OWN_CHOICE
        offset_light = base_light * LIGHT_PATH_OF(ways, j);
#endif
#if TRAIT_APART
        const uint state = AT_UINT(offset, state, at);
        const int is_full = state == connection_full;
        is_open |= is_full;
        offset_light = is_full ? base_light : offset_light;
        offset_light *= r_max(AT(shift, light_density, at), R(0));
#endif
        const real open = is_open ? R(1) : R(0);
        rgb found_there = rgb_scale(rgb_mul(so_far, radiance), open);
        rgb mine = base;
        real mine_other = base_light, density = offset_light + open * ratio, marker = ratio;
#if TRAIT_APART
        const int is_apart = state < connection_recent;
        const real own_pdf = AT(offset, pdf, at);
        const int sent = (int)(j * stride) + row;
        const uint offset_primitive = AT_UINT(offset_ray, primitive, sent);
#if ESCAPED
#if TRAIT_LIGHT_ENVIRONMENT
        /* A path that copied has a direction of its own; of one that sent no ray what is there is not used. */
        const light_found own =
            light_escaped(lights, environment_light, unit,
                          v3_select(is_apart, AT_V3(offset_ray, direction, sent), direction) ENVIRONMENT_ARGUMENTS);
#else
        const light_found own = found;
#endif
        marker =
            is_apart && offset_primitive != ray_escaped ? r_min(ratio, shift_failed(outcome_failed_nothing)) : ratio;
#else
        const uint present = offset_primitive < ray_first_special ? offset_primitive : 0u;
        const vec3 own_origin = AT_V3(offset_ray, origin, sent), own_direction = AT_V3(offset_ray, direction, sent);
        light_found own = light_found_at(primitive_light, lights, light_count, unit, triangle_count, present,
                                         primitive_hit_of(triangles, spheres, unit, triangle_count,
                                                          present INSTANCE_IN(offset_ray, offset_ray, sent), own_origin,
                                                          own_direction),
                                         own_origin, own_direction LIGHT_TEXTURE_ARGUMENTS);
#if OWN_CHOICE
        const light_receiver own_receiver = LIGHT_RECEIVER(own_origin, AT_UINT(shift, receiver, at), ratio);
        own.pdf *= light_tree_path(light_nodes, TRAIT_LIGHT_TREE, unit, light_leaf[(int)own.light], own_receiver);
#endif
#endif
        real own_light = own_pdf > R(0) ? own.pdf / own_pdf : R(0);
        real own_share = R(1);
#if STRATEGY == STRATEGY_BSDF
        own_light = R(0);
#endif
#if STRATEGY == STRATEGY_LIGHT
        own_light = R(0);
        own_share = own_pdf > R(0) ? R(0) : R(1);
#endif
        const rgb own_value = rgb_scale(rgb_mul(so_far, own.radiance), own_share / (R(1) + own_light));
        found_there = rgb_select(is_apart, own_value, found_there);
        mine = rgb_select(is_apart, alone, base);
        mine_other = is_apart ? R(0) : base_light;
        density = is_apart ? ratio : density;
#endif
        const rgb change = weighted_difference(mine, found_there, mine_other, density, marker);
        ADD_RGB(difference, value, to_slot, change);
    }
}
