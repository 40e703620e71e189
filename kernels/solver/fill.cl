/* Pixels without a value of their own take the mean of their neighbours, ring by ring. */
#include "kernels/solver/grid.h"

/* One ring: a pixel that is not `valid` and has valid neighbours gets their mean. Also the parts of the number of
 * pixels that are still not valid. */
SOLVE fill_ring(GRID, uint partials, __global const real *image, __global const real *valid,
                __global real *filled_image, __global real *filled_valid, __global real *partial) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const size_t at = GRID_AT(0, x, y);
    const real left = valid[at - 1], right = valid[at + 1], up = valid[at - row], down = valid[at + row];
    const real count = (left + right) + (up + down);
    const bool inside = x < width && y < height;
    const bool fill = inside && valid[at] == R(0) && count > R(0);
#pragma unroll
    for (size_t channel = 0; channel < SOLVER_CHANNELS; ++channel) {
        const size_t i = GRID_AT(channel, x, y);
        const real sum = (left * image[i - 1] + right * image[i + 1]) + (up * image[i - row] + down * image[i + row]);
        filled_image[i] = fill ? sum / count : image[i];
    }
    filled_valid[at] = fill ? R(1) : valid[at];
    partial[tile * SOLVER_TILE + item] = inside && valid[at] == R(0) && !fill ? R(1) : R(0);
}

/* valid = 1 where an equation is left that holds the pixel. */
SOLVE mark_held(GRID, uint weight_plane, uint partials, __global const real *inverse_diagonal, __global real *valid,
                __global real *partial) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const size_t at = GRID_AT(0, x, y);
    bool held = true;
    for (size_t c = 0; c < SOLVER_WEIGHT_PLANES; ++c)
        held = held && inverse_diagonal[c * weight_plane + at] > R(0);
    valid[at] = held ? R(1) : R(0);
    partial[tile * SOLVER_TILE + item] = x < width && y < height && !held ? R(1) : R(0);
}

/* u += base - mean_factor SCALAR(mean_slot): the image itself. */
SOLVE add_base(GRID, uint mean_slot, real mean_factor, __global const real *scalars, __global const real *base,
               __global real *u) {
    SOLVER_PLACE
    const size_t at = GRID_AT(channel, x, y);
    u[at] = x < width ? base[at] + (u[at] - TIMES_IF_ANY(mean_factor, SCALAR(mean_slot))) : R(0);
}
