/* Between a grid and the next coarser one, whose pixels are 2 x 2 pixels of it.
 *
 * Neighbouring work-items would have to read or write every other pixel, which CPU devices do lane by lane. So an item
 * takes 16 pixels of a fine row, or 8 of a coarse one, as OpenCL vectors, and splits and joins even and odd ones in
 * registers. A work-group takes SOLVER_TILE coarse columns and 8 rows. */
#include "kernels/solver/grid.h"

#define COARSE uint first_row, uint coarse_width, uint coarse_height, uint coarse_row, uint coarse_plane
#define COARSE_AT(x, y) (channel * coarse_plane + ((y) + 1) * coarse_row + SOLVER_MARGIN + (x))
#define SOLVER_VECTOR_PLACE(rows)                                                                                      \
    const uint group = (uint)get_group_id(0), item = (uint)get_local_id(0);                                            \
    const uint tiles = (coarse_width + SOLVER_TILE - 1) / SOLVER_TILE;                                                 \
    const uint channel = group / tiles;                                                                                \
    const uint coarse_x = group % tiles * SOLVER_TILE + item % 8 * 8;                                                  \
    const uint vector_row = first_row + (uint)get_group_id(1) * 8 + item / 8;                                          \
    if (coarse_x >= coarse_width || vector_row >= (rows))                                                              \
        return;

/* Even and odd ones of 16 elements in two vectors of 8. Written out: oclgrind loses track of swizzles between vectors
 * of different lengths. */
#define EVEN(a, b) ((real8)((a).s0, (a).s2, (a).s4, (a).s6, (b).s0, (b).s2, (b).s4, (b).s6))
#define ODD(a, b) ((real8)((a).s1, (a).s3, (a).s5, (a).s7, (b).s1, (b).s3, (b).s5, (b).s7))

/* coarse = the sum of `fine` over 2 x 2 pixels. Borders of `fine` are zero. */
SOLVE restrict_sum(uint height, uint row, uint plane, COARSE, __global const real *fine, __global real *coarse) {
    SOLVER_VECTOR_PLACE(coarse_height)
    __global const real *from = fine + GRID_AT(channel, 2 * coarse_x, 2 * vector_row);
    const real8 low = vload8(0, from) + vload8(0, from + row), high = vload8(1, from) + vload8(1, from + row);
    vstore8(EVEN(low, high) + ODD(low, high), 0, coarse + COARSE_AT(coarse_x, vector_row));
}

/* The fine pixels that 8 coarse ones give in a row, linear between the centres of coarse pixels and constant beyond the
 * outermost. */
#define INTERPOLATE                                                                                                    \
    const uint y = vector_row, near_y = y / 2;                                                                         \
    const uint far_y = y % 2 ? min(near_y + 1, coarse_height - 1) : near_y - (near_y > 0 ? 1 : 0);                     \
    __global const real *near_row = coarse + COARSE_AT(coarse_x, near_y),                                              \
                        *far_row = coarse + COARSE_AT(coarse_x, far_y);                                                \
    const real8 here = R(0.75) * vload8(0, near_row) + R(0.25) * vload8(0, far_row);                                   \
    const real8 left = R(0.75) * vload8(0, near_row - 1) + R(0.25) * vload8(0, far_row - 1);                           \
    const real8 right = R(0.75) * vload8(0, near_row + 1) + R(0.25) * vload8(0, far_row + 1);                          \
    const real8 even = here + R(0.25) * vload8(0, coarse_left + coarse_x) * (left - here);                             \
    const real8 odd = here + R(0.25) * vload8(0, coarse_right + coarse_x) * (right - here);                            \
    const real16 joined = (real16)(even.s0, odd.s0, even.s1, odd.s1, even.s2, odd.s2, even.s3, odd.s3, even.s4,        \
                                   odd.s4, even.s5, odd.s5, even.s6, odd.s6, even.s7, odd.s7);                         \
    const uint at = GRID_AT(channel, 2 * coarse_x, y);                                                                 \
    const real16 correction = joined * vload16(0, column_inside + 2 * coarse_x);

#define INTERPOLATION_ARGUMENTS                                                                                        \
    uint height, uint row, uint plane, COARSE, __global const real *coarse, __global const real *coarse_left,          \
        __global const real *coarse_right, __global const real *column_inside

/* u += the interpolated coarse grid. */
SOLVE prolong(INTERPOLATION_ARGUMENTS, __global real *u) {
    SOLVER_VECTOR_PLACE(height)
    INTERPOLATE
    vstore16(vload16(0, u + at) + correction, 0, u + at);
}

/* u += smoothed + the interpolated coarse grid. */
SOLVE prolong_onto(INTERPOLATION_ARGUMENTS, __global const real *smoothed, __global real *u) {
    SOLVER_VECTOR_PLACE(height)
    INTERPOLATE
    vstore16(vload16(0, u + at) + (vload16(0, smoothed + at) + correction), 0, u + at);
}

#if SOLVER_WEIGHTED
/* The weights of a coarse grid: data terms add up; of the edges between two coarse pixels, two fine ones cross, over
 * half the distance, so their mean counts. */
SOLVE coarsen_weights(uint row, uint weight_plane, COARSE, uint coarse_weight_plane, __global const real *weight_x,
                      __global const real *weight_y, __global const real *weight_data, __global real *coarse_weight_x,
                      __global real *coarse_weight_y, __global real *coarse_weight_data) {
    SOLVER_VECTOR_PLACE(coarse_height)
    const uint at = channel * weight_plane + (2 * vector_row + 1) * row + SOLVER_MARGIN + 2 * coarse_x;
    const uint to = channel * coarse_weight_plane + (vector_row + 1) * coarse_row + SOLVER_MARGIN + coarse_x;
    const real8 x_low = vload8(0, weight_x + at) + vload8(0, weight_x + at + row);
    const real8 x_high = vload8(1, weight_x + at) + vload8(1, weight_x + at + row);
    const real8 y_low = vload8(0, weight_y + at + row), y_high = vload8(1, weight_y + at + row);
    const real8 data_low = vload8(0, weight_data + at) + vload8(0, weight_data + at + row);
    const real8 data_high = vload8(1, weight_data + at) + vload8(1, weight_data + at + row);
    vstore8(R(0.5) * ODD(x_low, x_high), 0, coarse_weight_x + to);
    vstore8(R(0.5) * (EVEN(y_low, y_high) + ODD(y_low, y_high)), 0, coarse_weight_y + to);
    vstore8(EVEN(data_low, data_high) + ODD(data_low, data_high), 0, coarse_weight_data + to);
}
#endif
