/* escape: adds the environment's light to the paths that left the scene: rows index[first] on. */
//! traits: TRAIT_HIDE_EMITTERS
#include "kernels/lib/mis.h"
#include "kernels/shared/stage.h"

STAGE escape(uint count, uint unit, uint first, uint capacity, uint slots, __global const uint *index,
             __global const real *vertex_old, __global real *radiance, __global const real *lights,
             uint environment_light) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const uint row = index[first + i];
    const uint slot = AT_UINT_IN(vertex_old, vertex, slot, row);
    const real pdf_light = FIELD_OF(light, lights, environment_light, probability) * (R(0.25) * GRADUS_INV_PI);
    real weight = mis_weight_bsdf(AT_IN(vertex_old, vertex, pdf, row), pdf_light);
#if TRAIT_HIDE_EMITTERS
    weight = AT_UINT_IN(vertex_old, vertex, depth, row) > 0u ? weight : R(0);
#endif
    AT(radiance, value_r, slot) +=
        weight * FIELD_OF(light, lights, environment_light, value_r) * AT_IN(vertex_old, vertex, throughput_r, row);
    AT(radiance, value_g, slot) +=
        weight * FIELD_OF(light, lights, environment_light, value_g) * AT_IN(vertex_old, vertex, throughput_g, row);
    AT(radiance, value_b, slot) +=
        weight * FIELD_OF(light, lights, environment_light, value_b) * AT_IN(vertex_old, vertex, throughput_b, row);
}
