/* gradient_combine: joins what paths gathered before and after their offset paths merged with them: by slot, the primal
 * sample, the four differences, and in `radiance` the whole sample, with what the camera sees of lights. */
#include "kernels/lib/finite.h"
#include "kernels/lib/weighted_difference.h"
#include "kernels/shared/stage.h"

#define IS_FINITE_RGB(v) (is_finite((v).r) && is_finite((v).g) && is_finite((v).b))

STAGE gradient_combine(uint count, uint slots, __global real *radiance, __global const real *direct,
                       __global real *prefix, __global real *difference) {
    const size_t slot = work_item();
    if (slot >= count)
        return;
    const rgb after = AT_RGB(radiance, value, slot);
    const rgb base = rgb_mul(AT_RGB(prefix, throughput, slot), after);
    const rgb primal = rgb_add(AT_RGB(prefix, value, slot), base);
    const rgb seen = AT_RGB_IN(direct, radiance, value, slot);
    const rgb whole = rgb_add(primal, seen);
    SET_RGB(radiance, value, slot, whole);
    int finite = IS_FINITE_RGB(whole);
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * slots + slot;
        const real ratio = AT(difference, ratio, at);
        const int merged = ratio >= R(0);
        /* Only paths that merged have set their throughput. */
        const rgb throughput =
            rgb3(merged ? AT(difference, throughput_r, at) : R(0), merged ? AT(difference, throughput_g, at) : R(0),
                 merged ? AT(difference, throughput_b, at) : R(0));
        const rgb change = weighted_difference(base, rgb_mul(throughput, after), R(0), ratio, ratio);
        const rgb sum = rgb_add(AT_RGB(difference, value, at), change);
        SET_RGB(difference, value, at, sum);
        finite = finite && IS_FINITE_RGB(sum);
    }
    /* A sample that is no number is left out of everything; `accumulate` counts it by its radiance. */
    SET_RGB(prefix, value, slot, rgb3(finite ? primal.r : R(0), finite ? primal.g : R(0), finite ? primal.b : R(0)));
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * slots + slot;
        AT(difference, value_r, at) = finite ? AT(difference, value_r, at) : R(0);
        AT(difference, value_g, at) = finite ? AT(difference, value_g, at) : R(0);
        AT(difference, value_b, at) = finite ? AT(difference, value_b, at) : R(0);
    }
    AT(radiance, value_r, slot) = finite ? whole.r : R(NAN);
}
