/* From the solution u = I - I0 to the caller's planes. */
#include "kernels/solver/grid.h"

/* u += base - mean_factor SCALAR(mean_slot): the image itself. */
SOLVE add_base(GRID, uint mean_slot, real mean_factor, __global const real *scalars, __global const real *base,
               __global real *u) {
    SOLVER_PLACE
    const size_t at = GRID_AT(channel, x, y);
    u[at] = x < width ? base[at] + (u[at] - TIMES_IF_ANY(mean_factor, SCALAR(mean_slot))) : R(0);
}

/* packed = base + u - SCALAR(mean_slot) * mean_factor (+ direct). */
SOLVE compose(GRID, uint mean_slot, real mean_factor, uint has_direct, __global const real *scalars,
              __global const real *base, __global const real *u, __global const float *direct, __global float *packed) {
    SOLVER_PLACE
    const size_t at = GRID_AT(channel, x, y), packed_at = (channel * height + y) * width + x;
    const real image = base[at] + (u[at] - TIMES_IF_ANY(mean_factor, SCALAR(mean_slot)));
    /* Here, not before: what follows a condition is done lane by lane where it holds a division, as that for y. */
    if (x < width)
        packed[packed_at] = (float)(has_direct ? image + direct[packed_at] : image);
}
