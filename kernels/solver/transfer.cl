/* Between a grid and the next coarser one, whose pixels are 2 x 2 pixels of it. A work-group takes SOLVER_TILE coarse
 * columns and 8 rows. */
#include "kernels/solver/vectors.h"

#define COARSE uint coarse_width, uint coarse_height, uint coarse_row, uint coarse_plane
#define COARSE_AT(x, y) (own * coarse_plane + ((y) + 1) * coarse_row + SOLVER_MARGIN + (x))
#define SOLVER_VECTOR_PLACE(rows)                                                                                      \
    const uint group = (uint)get_group_id(0), item = (uint)get_local_id(0);                                            \
    const uint tiles = (coarse_width + SOLVER_TILE - 1) / SOLVER_TILE;                                                 \
    const uint own = group / tiles;                                                                                    \
    const uint coarse_x = group % tiles * SOLVER_TILE + item % 8 * 8;                                                  \
    const uint vector_row = (uint)get_group_id(1) * 8 + item / 8;                                                      \
    if (coarse_x >= coarse_width || vector_row >= (rows))                                                              \
        return;

/* u += what 8 coarse pixels give to 16 fine ones; 0 beyond the grid. */
SOLVE prolong(uint width, uint height, uint row, uint plane, COARSE, __global const real *coarse,
              __global const real *coarse_left, __global const real *coarse_right, __global real *u) {
    SOLVER_VECTOR_PLACE(height)
    const uint y = vector_row, at = OWN_AT(2 * coarse_x, y);
    const real16 correction =
        interpolated(coarse + COARSE_AT(coarse_x, y / 2), coarse + COARSE_AT(coarse_x, far_row_of(y, coarse_height)),
                     vload8(0, coarse_left + coarse_x), vload8(0, coarse_right + coarse_x));
    vstore16(within_grid(vload16(0, u + at) + correction, 2 * coarse_x, width), 0, u + at);
}

#if SOLVER_WEIGHTED
/* The weights of a coarse grid: data terms add up; of the edges between two coarse pixels, two fine ones cross, over
 * half the distance, so their mean counts. */
SOLVE coarsen_weights(uint row, uint weight_plane, COARSE, uint coarse_weight_plane, __global const real *weight_x,
                      __global const real *weight_y, __global const real *weight_data, __global real *coarse_weight_x,
                      __global real *coarse_weight_y, __global real *coarse_weight_data) {
    SOLVER_VECTOR_PLACE(coarse_height)
    const uint at = own * weight_plane + (2 * vector_row + 1) * row + SOLVER_MARGIN + 2 * coarse_x;
    const uint to = own * coarse_weight_plane + (vector_row + 1) * coarse_row + SOLVER_MARGIN + coarse_x;
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
