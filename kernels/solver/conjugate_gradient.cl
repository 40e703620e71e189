/* Conjugate gradients, each channel on its own (Hestenes and Stiefel 1952). Scalars stay on the device. */
#include "kernels/solver/tiles.h"

#define DIRECTION(at) (vload8(0, z + (at)) + beta * vload8(0, old_direction + (at)))

/* direction = z + beta old_direction, image = A direction, and the parts of <direction, image>.
 * beta = factor * SCALAR(numerator) / SCALAR(divisor), at most `bound` in size. */
SOLVE direction(TILED_GRID, WEIGHTS_OF_DIAGONAL, real factor, real bound, uint numerator, uint divisor, uint partials,
                __global const real *scalars, __global const real *z, __global const real *old_direction,
                __global real *direction, __global real *image, __global real *partial) {
    TILE_PLACE
    const real ratio = SCALAR_RATIO(numerator, divisor);
    const real beta = TIMES_IF_ANY(factor, r_clamp(ratio, -bound, bound));
    FOR_LINES(rows) {
        const uint y = first_y + line;
        ON_LINE
        FOR_EIGHTS(0, EIGHTS(columns)) {
            const size_t x = first_x + 8 * eight, at = line_at + x;
            const real8 here = DIRECTION(at);
            const real8 a = image_of_8(CELLS(x, y), here, DIRECTION(at - 1), DIRECTION(at + 1), DIRECTION(at - row),
                                       DIRECTION(at + row));
            vstore8(here, 0, direction + at);
            vstore8(a, 0, image + at);
            const real8 product = here * a;
            partial[TILE_PARTIAL(0, x, y)] = SUM_OF_8(product);
        }
    }
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
