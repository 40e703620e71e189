/* escape: adds the environment's light to the paths that left the scene: rows index[first] on. */
//! traits: TRAIT_HIDE_EMITTERS
#include "kernels/lib/mis.h"
#include "kernels/shared/stage.h"

STAGE escape(uint count, uint unit, uint first, uint capacity, uint slots, __global const uint *index,
             __global const real *path, __global real *radiance, __global const real *lights, uint environment_light) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const uint row = index[first + i];
    const uint slot = AT_UINT(path, slot, row);
    const real pdf_light = FIELD_OF(light, lights, environment_light, probability) * (R(0.25) * GRADUS_INV_PI);
    real weight = mis_weight_bsdf(AT(path, pdf, row), pdf_light);
#if TRAIT_HIDE_EMITTERS
    weight = AT_UINT(path, depth, row) > 0u ? weight : R(0);
#endif
    AT(radiance, value_r, slot) +=
        weight * FIELD_OF(light, lights, environment_light, value_r) * AT(path, throughput_r, row);
    AT(radiance, value_g, slot) +=
        weight * FIELD_OF(light, lights, environment_light, value_g) * AT(path, throughput_g, row);
    AT(radiance, value_b, slot) +=
        weight * FIELD_OF(light, lights, environment_light, value_b) * AT(path, throughput_b, row);
}
