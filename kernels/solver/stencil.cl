/* What iterations do with the operator A: residuals and smoothing. */
#include "kernels/solver/grid.h"

/* residual = right_side - A u. */
SOLVE residual(GRID, WEIGHTS_OF_DIAGONAL, __global const real *u, __global const real *right_side,
               __global real *residual) {
    SOLVER_PLACE
    residual[OWN_AT(x, y)] = RESIDUAL(x, y);
}

/* One step of smoothing, or of Jacobi's method: smoothed = u + step_size (right_side - A u) / D. */
SOLVE smooth(GRID, WEIGHTS, real step_size, __global const real *u, __global const real *right_side,
             __global real *smoothed) {
    SOLVER_PLACE
    const size_t at = OWN_AT(x, y);
    smoothed[at] = u[at] + step_size * inverse_diagonal[WEIGHT_AT(x, y)] * RESIDUAL(x, y);
}

/* to = from. */
SOLVE copy(GRID, __global const real *from, __global real *to) {
    SOLVER_PLACE
    to[OWN_AT(x, y)] = from[OWN_AT(x, y)];
}

/* The inverse of the operator's diagonal; 0 where no weight is left, and in the border. */
SOLVE invert_diagonal(GRID, WEIGHTS_OF_DIAGONAL, __global real *inverse_diagonal) {
    SOLVER_PLACE
    const cell_weights c = CELL(x, y);
    const real diagonal = c.data + ((c.left + c.right) + (c.up + c.down));
    inverse_diagonal[WEIGHT_AT(x, y)] = diagonal > R(0) ? R(1) / diagonal : R(0);
}

#if !SOLVER_WEIGHTED
/* Uniform weights, stored by pixel. */
SOLVE store_weights(GRID, WEIGHTS_OF_DIAGONAL, __global real *weight_x, __global real *weight_y,
                    __global real *weight_data) {
    SOLVER_PLACE
    const size_t at = WEIGHT_AT(x, y);
    const cell_weights c = CELL(x, y);
    weight_x[at] = c.right;
    weight_y[at] = c.down;
    weight_data[at] = c.data;
}
#endif
