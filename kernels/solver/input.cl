/* From the caller's planes to the system for u = I - I0: what the differences of I0 lack of the given ones. A value
 * that is NaN or infinite is missing. */
#include "kernels/lib/finite.h"
#include "kernels/solver/grid.h"

/* An image of the caller's, 0 where it is missing; `valid` is 1 where all channels are there; and how many are not. */
SOLVE import_image(GRID, uint edge_columns, uint edge_rows, uint partials, __global const float *packed,
                   __global real *imported, __global real *valid, __global real *partial) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    /* Differences have one column or row less than the image. */
    const bool inside = x < edge_columns && y < edge_rows;
    uint missing = 0;
#pragma unroll
    for (uint channel = 0; channel < SOLVER_CHANNELS; ++channel)
        missing |= is_finite(inside ? packed[PACKED_AT(channel)] : 0.0f) ? 0 : 1;
#pragma unroll
    for (uint channel = 0; channel < SOLVER_CHANNELS; ++channel) {
        const real value = inside ? packed[PACKED_AT(channel)] : 0.0f;
        imported[GRID_AT(channel, x, y)] = missing ? R(0) : value;
    }
    valid[GRID_AT(0, x, y)] = inside && missing == 0 ? R(1) : R(0);
    partial[tile * SOLVER_TILE + item] = missing;
}

/* A plane of variances, -1 where one is missing, as those below 0 are; and the parts of two sums: of those that are
 * there, or of their fourth roots, and how many are not. */
SOLVE import_variance(GRID, uint edge_columns, uint edge_rows, uint of_roots, uint partials,
                      __global const float *packed, __global real *imported, __global real *partial) {
    SOLVER_PLACE
    const bool inside = x < edge_columns && y < edge_rows;
    const real value = inside ? packed[PACKED_AT(channel)] : 0.0f;
    const bool is_there = is_finite(value) && value >= R(0);
    imported[GRID_AT(channel, x, y)] = is_there ? value : R(-1);
    const size_t part = tile * SOLVER_TILE + item;
    const real there = is_there ? value : R(0);
    partial[part] = of_roots ? r_sqrt(r_sqrt(there)) : there;
    partial[partials + part] = is_there ? R(0) : R(1);
}

/* gradient_x = Gx - Dx I0 and gradient_y likewise, 0 where Gx or Gy is missing. */
SOLVE gradient_residual(GRID, __global const real *base, __global const real *dx, __global const real *dy,
                        __global const real *valid_dx, __global const real *valid_dy, __global real *gradient_x,
                        __global real *gradient_y) {
    SOLVER_PLACE
    const size_t at = GRID_AT(channel, x, y), w = GRID_AT(0, x, y);
    gradient_x[at] = valid_dx[w] * (dx[at] - (base[at + 1] - base[at]));
    gradient_y[at] = valid_dy[w] * (dy[at] - (base[at + row] - base[at]));
}

/* right_side = the transposed differences of the weighted gradient residual. */
SOLVE right_side(GRID, WEIGHTS_OF_DIAGONAL, __global const real *gradient_x, __global const real *gradient_y,
                 __global real *right_side) {
    SOLVER_PLACE
    const size_t at = GRID_AT(channel, x, y);
    const cell_weights c = CELL(x, y);
    right_side[OWN_AT(x, y)] = (c.left * gradient_x[at - 1] - c.right * gradient_x[at]) +
                               (c.up * gradient_y[at - row] - c.down * gradient_y[at]);
}

/* u = 0, cut to between the second least and the second largest value that the differences give from the neighbours. So
 * a pixel of I0 that is far off by itself does not stay where it is, which is right where its differences outweigh it:
 * with an alpha below 3 (solver/reweighting.cpp). But not where I0 + u would lose more than three digits to
 * cancellation, which would be noise to all equations of the pixel. */
SOLVE start_between_neighbours(GRID, __global const real *base, __global const real *gradient_x,
                               __global const real *gradient_y, __global real *u) {
    SOLVER_PLACE
    const size_t at = GRID_AT(channel, x, y);
    const real left = gradient_x[at - 1], right = -gradient_x[at];
    const real up = gradient_y[at - row], down = -gradient_y[at];
    const real less_x = r_min(left, right), more_x = r_max(left, right);
    const real less_y = r_min(up, down), more_y = r_max(up, down);
    const real lower = r_min(r_max(less_x, less_y), r_min(more_x, more_y));
    const real upper = r_max(r_min(more_x, more_y), r_max(less_x, less_y));
    const real between = r_clamp(R(0), lower, upper);
    u[at] = r_abs(between) <= R(1000) * r_abs(base[at] + between) ? between : R(0);
}

/* u = start - base, where there is a start and it is finite; else 0. */
SOLVE start(GRID, uint has_start, __global const real *base, __global const float *packed, __global real *u) {
    SOLVER_PLACE
    const size_t at = GRID_AT(channel, x, y);
    /* No NAN of our own: relaxed arithmetic may take it for anything. */
    const bool given = has_start && x < width;
    const float value = given ? packed[PACKED_AT(channel)] : 0.0f;
    u[at] = given && is_finite(value) ? value - base[at] : R(0);
}
