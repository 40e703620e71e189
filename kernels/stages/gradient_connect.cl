/* gradient_connect: adds the light sampled at the vertices where all offset paths are connected (rows `first` on) to
 * the base path and to its differences, if it is seen: `join` has left what each gains. */
#include "kernels/lib/mis.h"
#include "kernels/lib/weighted_difference.h"
#include "kernels/shared/stage.h"

STAGE gradient_connect(uint count, uint first, uint capacity, uint slots, __global const real *path,
                       __global const real *shadow, __global const real *event, __global const real *evaluation,
                       __global const real *shift, __global real *prefix, __global real *difference) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = first + i;
    const int slot = AT_ROW(path, slot, row);
    const int seen = AT_UINT(shadow, open, row) != 0u;
    /* Selected, not scaled: where nothing was asked nothing was written. */
    const rgb base = rgb_select(seen, AT_RGB(shadow, value, row), rgb_gray(R(0)));
    const real base_bsdf = seen ? AT(event, base_bsdf, row) : R(0);
    const rgb alone = rgb_scale(base, R(1) / (R(1) + base_bsdf));
    ADD_RGB(prefix, value, slot, alone);
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + row;
        const int to = (int)(j * slots) + slot;
        const rgb offset = rgb_select(seen, AT_RGB(evaluation, value, at), rgb_gray(R(0)));
        const real ratio = seen ? AT(shift, light_density, at) : R(0);
        const real offset_bsdf = seen ? AT(evaluation, pdf, at) : R(0);
        const real weight = weight_of_light_at_shared_vertex(base_bsdf, offset_bsdf, ratio);
        const rgb change = difference_of(base, offset, weight, ratio);
        ADD_RGB(difference, value, to, change);
    }
}
