/* escape: adds the environment's light to the paths that left the scene: rows index[first] on.
 *
 * DIRECT_APART: what the camera sees of it goes to `direct`. */
//! traits: TRAIT_HIDE_EMITTERS TRAIT_LIGHT_ENVIRONMENT
#include "kernels/lib/escaped_light.h"
#include "kernels/lib/mis.h"
#include "kernels/shared/stage.h"

STAGE escape(uint count, uint unit, uint first, uint capacity, uint slots, __global const uint *index,
             __global const real *path, __global real *radiance, __global const real *lights, uint environment_light
#if TRAIT_LIGHT_ENVIRONMENT
             ,
             __global const real *ray ENVIRONMENT_PARAMETERS
#endif
#if DIRECT_APART
             ,
             __global real *direct
#endif
) {
    const size_t i = work_item();
    uint kept = 0u;
#if TRAIT_LIGHT_ENVIRONMENT
    kept = ESCAPED_BITS(environment_light);
#endif
    if (!HAS_ROW(i, count, kept))
        return;
    const int row = AT_INDEX(first + i);
    const int slot = AT_ROW(path, slot, row);
    vec3 direction = v3(R(0), R(0), R(1));
#if TRAIT_LIGHT_ENVIRONMENT
    direction = AT_V3(ray, direction, row);
#endif
    const light_found found = light_escaped(lights, environment_light, unit, direction ENVIRONMENT_ARGUMENTS);
    real weight = mis_weight_bsdf(AT(path, pdf, row), found.pdf);
#if TRAIT_HIDE_EMITTERS
    weight = AT_UINT(path, depth, row) > 0u ? weight : R(0);
#endif
    const rgb gained = rgb_mul(rgb_scale(found.radiance, weight), AT_RGB(path, throughput, row));
#if DIRECT_APART
    const int is_seen = AT_UINT(path, depth, row) == 0u;
    const rgb seen = rgb_add(AT_RGB_IN(direct, radiance, value, slot), rgb_select(is_seen, gained, rgb_gray(R(0))));
    SET_RGB_IN(direct, radiance, value, slot, seen);
    const rgb later = rgb_select(is_seen, rgb_gray(R(0)), gained);
    ADD_RGB(radiance, value, slot, later);
#else
    ADD_RGB(radiance, value, slot, gained);
#endif
}
