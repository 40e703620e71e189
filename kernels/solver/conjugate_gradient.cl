/* Conjugate gradients, each channel on its own (Hestenes and Stiefel 1952). Scalars stay on the device. */
#include "kernels/solver/grid.h"

/* direction = z + beta old_direction, and image = A direction.
 * beta = factor * SCALAR(numerator) / SCALAR(divisor), at most `bound` in size. */
SOLVE direction(GRID, WEIGHTS_OF_DIAGONAL, real factor, real bound, uint numerator, uint divisor,
                __global const real *scalars, __global const real *z, __global const real *old_direction,
                __global real *direction, __global real *image) {
    SOLVER_PLACE
    const size_t at = OWN_AT(x, y);
    const real ratio = SCALAR_RATIO(numerator, divisor);
    const real beta = factor * r_clamp(ratio, -bound, bound);
    const cell_weights c = CELL(x, y);
    const real here = z[at] + beta * old_direction[at];
    const real left = z[at - 1] + beta * old_direction[at - 1];
    const real right = z[at + 1] + beta * old_direction[at + 1];
    const real up = z[at - row] + beta * old_direction[at - row];
    const real down = z[at + row] + beta * old_direction[at + row];
    const real a = c.data * here + (c.left * (here - left) + c.right * (here - right)) +
                   (c.up * (here - up) + c.down * (here - down));
    direction[at] = here;
    image[at] = a;
}

/* u += alpha direction, residual -= alpha image, alpha = SCALAR(numerator) / SCALAR(divisor), at most `bound` in
 * size. */
SOLVE advance(GRID, real bound, uint numerator, uint divisor, __global const real *scalars,
              __global const real *direction, __global const real *image, __global real *u, __global real *residual) {
    SOLVER_PLACE
    const size_t at = OWN_AT(x, y);
    const real ratio = SCALAR_RATIO(numerator, divisor);
    const real alpha = r_clamp(ratio, -bound, bound);
    u[at] += alpha * direction[at];
    residual[at] -= alpha * image[at];
}
