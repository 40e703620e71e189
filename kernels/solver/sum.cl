/* Sums in a fixed order: each item adds SOLVER_REDUCTION parts, far apart, until few are left; those are added in twice
 * the precision. The error grows with the logarithm of the count. */
#include "kernels/solver/grid.h"

/* The first step of <a, b> and, with `has_second`, of <a, c>: `reduced` as by `reduce`, from the planes as they lie in
 * memory, borders and all, for those are zero; the size of a plane is a multiple of SOLVER_REDUCTION * SOLVER_TILE. */
GRADUS_FN void add_products(int has_second, uint plane, uint channel_count, uint reduced_count, __global const real *a,
                            __global const real *b, __global const real *c, __global real *reduced) {
    const uint channel = (uint)get_group_id(1);
    const size_t i = get_global_id(0);
    const size_t first = (size_t)channel * plane;
    real sum = R(0), second = R(0);
#pragma unroll
    for (uint k = 0; k < SOLVER_REDUCTION; ++k) {
        const size_t at = i + (size_t)k * reduced_count;
        sum += a[first + at] * b[first + at];
        if (has_second)
            second += a[first + at] * c[first + at];
    }
    reduced[(size_t)channel * reduced_count + i] = sum;
    if (has_second)
        reduced[(size_t)(channel_count + channel) * reduced_count + i] = second;
}

SOLVE reduce_products(uint plane, uint channel_count, uint reduced_count, __global const real *a,
                      __global const real *b, __global const real *c, __global real *reduced) {
    add_products(0, plane, channel_count, reduced_count, a, b, c, reduced);
}

SOLVE reduce_two_products(uint plane, uint channel_count, uint reduced_count, __global const real *a,
                          __global const real *b, __global const real *c, __global real *reduced) {
    add_products(1, plane, channel_count, reduced_count, a, b, c, reduced);
}

/* The same for the sum of a. */
SOLVE reduce_plane(uint plane, uint reduced_count, __global const real *a, __global real *reduced) {
    const uint channel = (uint)get_group_id(1);
    const size_t i = get_global_id(0);
    const size_t first = (size_t)channel * plane;
    real sum = R(0);
#pragma unroll
    for (uint k = 0; k < SOLVER_REDUCTION; ++k) {
        const size_t at = i + (size_t)k * reduced_count;
        sum += a[first + at];
    }
    reduced[(size_t)channel * reduced_count + i] = sum;
}

/* reduced[i] = sum over k of partial[i + k * reduced_count], for each of the `planes` blocks of `count` parts. */
SOLVE reduce(uint count, uint reduced_count, __global const real *partial, __global real *reduced) {
    const uint plane = (uint)get_group_id(1);
    const size_t i = get_global_id(0);
    real sum = R(0);
    __global const real *from = partial + (size_t)plane * count;
#pragma unroll
    for (uint k = 0; k < SOLVER_REDUCTION; ++k) {
        const size_t at = i + (size_t)k * reduced_count;
        sum += i < reduced_count && at < count ? from[at] : R(0);
    }
    if (i < reduced_count)
        reduced[(size_t)plane * reduced_count + i] = sum;
}

/* SCALAR(slot) of each of channel_count channels and, where there are two sums, SCALAR(second_slot). */
SOLVE finish_sum(uint count, uint sums, uint first_channel, uint channel_count, uint slot, uint second_slot,
                 __global const real *partial, __global real *scalars) {
    if (get_global_id(0) != 0)
        return;
    for (uint sum = 0; sum < sums; ++sum)
        for (uint plane = 0; plane < channel_count; ++plane) {
            const uint channel = first_channel + plane;
            compensated total;
            total.sum = R(0);
            total.correction = R(0);
            for (uint i = 0; i < count; ++i)
                total = compensated_add(total, partial[(sum * channel_count + plane) * count + i]);
            SCALAR(sum == 0 ? slot : second_slot) = total.sum + total.correction;
        }
}
