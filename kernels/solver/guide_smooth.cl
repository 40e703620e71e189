/* Gaussian means over the neighbourhood, along rows and then along columns, GUIDE_TAPS pixels far. The taps are the
 * host's; what lies outside of the image is zero, so that a plane of ones smoothed alike tells how much was inside. */
#include "kernels/solver/grid.h"

SOLVE guide_smooth_rows(GRID, __global const real *taps, __global const real *image, __global real *smoothed) {
    SOLVER_PLACE
    const size_t at = GRID_AT(channel, x, y);
    real sum = R(0);
#pragma unroll
    for (int d = -GUIDE_TAPS; d <= GUIDE_TAPS; ++d)
        sum += taps[d + GUIDE_TAPS] * image[at + d];
    smoothed[at] = sum;
}

SOLVE guide_smooth_columns(GRID, __global const real *taps, __global const real *image, __global real *smoothed) {
    SOLVER_PLACE
    /* The border's rows are zero. Each line is found from the one before: found apart they are packed (ordered.h). */
    const size_t top = GRID_AT(channel, x, 0) - row;
    uint line = y + 1 > GUIDE_TAPS ? (uint)y + 1 - GUIDE_TAPS : 0;
    real sum = R(0);
#pragma unroll
    for (int d = -GUIDE_TAPS; d <= GUIDE_TAPS; ++d) {
        sum += taps[d + GUIDE_TAPS] * image[top + (size_t)line * row];
        line += (int)y + 1 + d >= 0 && line <= height ? 1 : 0;
    }
    smoothed[GRID_AT(channel, x, y)] = sum;
}
