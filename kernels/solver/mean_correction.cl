/* The right side of the correction that brings local means back to those of I0: what I0 has more than the
 * reconstruction, outliers cut. solver/mean_correction.h says how and why. */
#include "kernels/solver/grid.h"

/* Keeps the three largest values, a >= b >= c. */
#define KEEP_LARGEST(a, b, c, value)                                                                                   \
    {                                                                                                                  \
        const real v = value;                                                                                          \
        const real under_a = r_min(a, v);                                                                              \
        a = r_max(a, v);                                                                                               \
        const real under_b = r_min(b, under_a);                                                                        \
        b = r_max(b, under_a);                                                                                         \
        c = r_max(c, under_b);                                                                                         \
    }

/* For each column and row of blocks: the three largest |u| of the column in the block, |.| over channels. */
SOLVE largest_of_columns(GRID, uint columns, __global const real *u, __global const real *valid,
                         __global real *largest) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    real a = R(0), b = R(0), c = R(0);
    for (uint k = 0; k < SOLVER_BLOCK; ++k) {
        const size_t line = y * SOLVER_BLOCK + k;
        const size_t at = GRID_AT(0, x, line < height ? line : height - 1);
        real norm = R(0);
#pragma unroll
        for (size_t channel = 0; channel < SOLVER_CHANNELS; ++channel)
            norm += u[channel * plane + at] * u[channel * plane + at];
        KEEP_LARGEST(a, b, c, line < height ? valid[at] * r_sqrt(norm) : R(0))
    }
    const size_t to = y * columns + x;
    largest[3 * to] = a;
    largest[3 * to + 1] = b;
    largest[3 * to + 2] = c;
}

/* The third largest of each block. */
SOLVE third_largest(uint blocks_x, uint blocks, uint columns, __global const real *largest, __global real *bound) {
    const uint i = (uint)get_global_id(0);
    if (i >= blocks)
        return;
    const uint block_x = i % blocks_x, block_y = i / blocks_x;
    real a = R(0), b = R(0), c = R(0);
    for (uint k = 0; k < 3 * SOLVER_BLOCK; ++k)
        KEEP_LARGEST(a, b, c, largest[3 * (block_y * columns + block_x * SOLVER_BLOCK) + k])
    bound[i] = c;
}

/* |I| at a pixel, the mean of the channels that share a weight; at least `least`. */
#define BRIGHTNESS(at) brightness(base, u, at, plane, least)
GRADUS_FN real brightness(__global const real *base, __global const real *u, size_t at, uint plane, real least) {
    real sum = R(0);
#pragma unroll
    for (size_t c = 0; c < CHANNELS_TOGETHER; ++c)
        sum += r_abs(base[at + c * plane] + u[at + c * plane]);
    return r_max(sum / CHANNELS_TOGETHER, least);
}

/* The weights of the system for the correction relative to |I|: |I| of the darker pixel for edges, smoothness^2 |I| for
 * pixels, but 0 where the primal is missing: there the correction is that of the pixels around. */
SOLVE correction_weights(GRID, uint weight_plane, real least, real smoothness, __global const real *base,
                         __global const real *u, __global const real *valid, __global real *weight_x,
                         __global real *weight_y, __global real *weight_data) {
    SOLVER_PLACE
    const size_t at = GRID_AT(FIRST_CHANNEL, x, y), to = channel * weight_plane + GRID_AT(0, x, y);
    const real here = BRIGHTNESS(at), right = BRIGHTNESS(at + 1), down = BRIGHTNESS(at + row);
    weight_x[to] = x + 1 < width ? r_min(here, right) : R(0);
    weight_y[to] = x < width && y + 1 < height ? r_min(here, down) : R(0);
    weight_data[to] = x < width ? smoothness * smoothness * here * valid[GRID_AT(0, x, y)] : R(0);
}

/* right_side = smoothness^2 times -u, outliers cut by the block's bound; 0 where the primal is missing. |u| over the
 * bound stays what it is up to 2, and falls back to 1 beyond. */
SOLVE correction_right_side(GRID, uint blocks_x, real smoothness, __global const real *u, __global const real *valid,
                            __global const real *bound, __global real *right_side) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const size_t at = GRID_AT(0, x, y);
    real norm = R(0);
#pragma unroll
    for (size_t channel = 0; channel < SOLVER_CHANNELS; ++channel)
        norm += u[channel * plane + at] * u[channel * plane + at];
    norm = r_sqrt(norm);
    const real limit = bound[y / SOLVER_BLOCK * blocks_x + (x < width ? x : 0) / SOLVER_BLOCK];
    const real over = r_min(norm / r_max(limit, R(1e-30)), R(1e30));
    const real cut = over > R(2) ? (R(1) + R(1) / (over - R(1))) / over : R(1);
    const real factor = x < width ? smoothness * smoothness * valid[at] * cut : R(0);
#pragma unroll
    for (size_t channel = 0; channel < SOLVER_CHANNELS; ++channel)
        right_side[channel * plane + at] = -factor * u[channel * plane + at];
}

/* Adds its share of what a pass has left to the correction, and asks the next pass to filter it again. */
SOLVE correction_pass(GRID, uint weight_plane, real share, __global const real *weight_data,
                      __global const real *passed, __global real *correction, __global real *right_side) {
    SOLVER_PLACE
    const size_t at = GRID_AT(channel, x, y);
    const size_t weight = (SOLVER_WEIGHT_PLANES > 1 ? channel * weight_plane : 0) + GRID_AT(0, x, y);
    const real left = passed[OWN_AT(x, y)];
    correction[at] += share * left;
    right_side[at] = weight_data[weight] * left;
}

/* correction = |I| times the relative correction, and corrected = u + correction. */
SOLVE add_correction(GRID, real least, __global const real *base, __global const real *u, __global real *correction,
                     __global real *corrected) {
    SOLVER_PLACE
    const size_t at = GRID_AT(channel, x, y);
    const size_t first = SOLVER_WEIGHT_PLANES > 1 ? at : GRID_AT(0, x, y);
    const real added = x < width ? BRIGHTNESS(first) * correction[at] : R(0);
    corrected[at] = u[at] + added;
    correction[at] = added;
}
