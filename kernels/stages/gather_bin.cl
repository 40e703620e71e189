/* gather_bin: the BSDF kinds of base paths' gather points, for who gathers kind by kind, by slot: a place in
 * SceneTables::kinds, or bin_none where there is no gather point. Sums of differences begin. */
#include "kernels/shared/stage.h"

STAGE gather_bin(uint count, uint gather_rows, uint slots, __global const real *gather,
                 __global const uint *bin_of_material, __global uint *gather_bin, __global real *difference) {
    const size_t slot = work_item();
    if (slot >= count)
        return;
    const int is_there = AT(gather, radius, slot) > R(0);
    const uint record = is_there ? AT_UINT(gather, material, slot) : 0u;
    const uint kind = bin_of_material[record];
    gather_bin[slot] = is_there ? kind : bin_none;
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * slots + slot;
        SET_RGB(difference, value, at, rgb_gray(R(0)));
    }
}
