/* Several pixels of a row at a time, as OpenCL vectors.
 *
 * Neighbouring work-items that read or write every other pixel would do so lane by lane on CPU devices. So between a
 * grid and the next coarser one, whose pixels are 2 x 2 pixels of it, an item takes 16 pixels of a fine row or 8 of a
 * coarse one, and splits and joins even and odd ones in registers. */
#ifndef GRADUS_SOLVER_VECTORS_H
#define GRADUS_SOLVER_VECTORS_H
#include "kernels/solver/grid.h"

/* Even and odd ones of 16 elements in two vectors of 8. Written out: oclgrind loses track of swizzles between vectors
 * of different lengths. */
#define EVEN(a, b) ((real8)((a).s0, (a).s2, (a).s4, (a).s6, (b).s0, (b).s2, (b).s4, (b).s6))
#define ODD(a, b) ((real8)((a).s1, (a).s3, (a).s5, (a).s7, (b).s1, (b).s3, (b).s5, (b).s7))

/* 16 elements, of which 8 are even and 8 odd. */
GRADUS_FN real16 joined(real8 even, real8 odd) {
    return (real16)(even.s0, odd.s0, even.s1, odd.s1, even.s2, odd.s2, even.s3, odd.s3, even.s4, odd.s4, even.s5,
                    odd.s5, even.s6, odd.s6, even.s7, odd.s7);
}

/* b - A u of 8 pixels, of which u[at] and b[at] are the first. */
GRADUS_FN real8 residual_of_8(real8 left, real8 right, real8 up, real8 down, real8 data, __global const real *u,
                              __global const real *b, size_t at, uint row) {
    const real8 here = vload8(0, u + at);
    return vload8(0, b + at) -
           (data * here + (left * (here - vload8(0, u + at - 1)) + right * (here - vload8(0, u + at + 1))) +
            (up * (here - vload8(0, u + at - row)) + down * (here - vload8(0, u + at + row))));
}

/* The weights of 8 pixels, as cell_weights has them of one: the first five arguments of residual_of_8. */
#define STORED_CELLS(w)                                                                                                \
    vload8(0, weight_x + (w)-1), vload8(0, weight_x + (w)), vload8(0, weight_y + (w)-row), vload8(0, weight_y + (w)),  \
        vload8(0, weight_data + (w))
#if SOLVER_WEIGHTED
#define CELLS(x, y) STORED_CELLS(WEIGHT_AT(x, y))
#else
#define CELLS(x, y)                                                                                                    \
    row_size[y] * vload8(0, column_left + (x)), row_size[y] * vload8(0, column_right + (x)),                           \
        row_up[y] * vload8(0, column_size + (x)), row_down[y] * vload8(0, column_size + (x)),                          \
        data *row_size[y] * vload8(0, column_size + (x))
#endif

/* What 8 coarse pixels in a row give to the row of fine ones: near_row has the coarse ones that hold it, far_row their
 * neighbours on its other side. Linear between the centres of coarse pixels, and constant beyond the outermost: there
 * `left_inside` and `right_inside` are 0, which are 1 elsewhere. */
GRADUS_FN real16 interpolated(__global const real *near_row, __global const real *far_row, real8 left_inside,
                              real8 right_inside) {
    const real8 here = R(0.75) * vload8(0, near_row) + R(0.25) * vload8(0, far_row);
    const real8 left = R(0.75) * vload8(0, near_row - 1) + R(0.25) * vload8(0, far_row - 1);
    const real8 right = R(0.75) * vload8(0, near_row + 1) + R(0.25) * vload8(0, far_row + 1);
    return joined(here + R(0.25) * left_inside * (left - here), here + R(0.25) * right_inside * (right - here));
}

/* The row of coarse pixels on the other side of fine row y from the one that holds it. */
GRADUS_FN uint far_row_of(uint y, uint coarse_height) {
    const uint near_y = y / 2;
    return y % 2 ? min(near_y + 1, coarse_height - 1) : near_y - (near_y > 0 ? 1 : 0);
}

#endif
