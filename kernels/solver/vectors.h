/* Several pixels of a row at a time, as OpenCL vectors.
 *
 * Between a grid and the next coarser one, whose pixels are 2 x 2 pixels of it, neighbouring work-items would read or
 * write every other pixel, which CPU devices do lane by lane. Eights and sixteens of pixels are split and joined in
 * registers. */
#ifndef GRADUS_SOLVER_VECTORS_H
#define GRADUS_SOLVER_VECTORS_H
#include "kernels/solver/grid.h"

/* Even and odd ones of 16 elements in two vectors of 8. Written out: oclgrind loses track of swizzles between vectors
 * of different lengths. */
#define EVEN(a, b) ((real8)((a).s0, (a).s2, (a).s4, (a).s6, (b).s0, (b).s2, (b).s4, (b).s6))
#define ODD(a, b) ((real8)((a).s1, (a).s3, (a).s5, (a).s7, (b).s1, (b).s3, (b).s5, (b).s7))

#define SUM_OF_8(v) ((((v).s0 + (v).s4) + ((v).s2 + (v).s6)) + (((v).s1 + (v).s5) + ((v).s3 + (v).s7)))

/* 16 elements, of which 8 are even and 8 odd. */
GRADUS_FN real16 joined(real8 even, real8 odd) {
    return (real16)(even.s0, odd.s0, even.s1, odd.s1, even.s2, odd.s2, even.s3, odd.s3, even.s4, odd.s4, even.s5,
                    odd.s5, even.s6, odd.s6, even.s7, odd.s7);
}

/* The weights of 8 pixels as five arguments: those of the edges to the left, to the right, up and down, and of data.
 * `line_weight` is where those of row y begin. */
#define CELLS_OF_8 real8 left, real8 right, real8 up, real8 down, real8 data
#define STORED_CELLS(w)                                                                                                \
    vload8(0, weight_x + (w)-1), vload8(0, weight_x + (w)), vload8(0, weight_y + (w)-row), vload8(0, weight_y + (w)),  \
        vload8(0, weight_data + (w))
#if SOLVER_WEIGHTED
#define CELLS(x, y) STORED_CELLS(line_weight + (x))
#else
#define CELLS(x, y)                                                                                                    \
    row_size[y] * vload8(0, column_left + (x)), row_size[y] * vload8(0, column_right + (x)),                           \
        row_up[y] * vload8(0, column_size + (x)), row_down[y] * vload8(0, column_size + (x)),                          \
        data *row_size[y] * vload8(0, column_size + (x))
#endif

/* An image's 8 pixels and those around them, as five arguments. */
#define AROUND_8(u) real8 u, real8 u##_left, real8 u##_right, real8 u##_up, real8 u##_down
#define AROUND(u, at, row)                                                                                             \
    vload8(0, (u) + (at)), vload8(0, (u) + (at)-1), vload8(0, (u) + (at) + 1), vload8(0, (u) + (at) - (row)),          \
        vload8(0, (u) + (at) + (row))

/* A u. */
GRADUS_FN real8 image_of_8(CELLS_OF_8, AROUND_8(u)) {
    return data * u + (left * (u - u_left) + right * (u - u_right)) + (up * (u - u_up) + down * (u - u_down));
}

/* Two steps of smoothing that start at zero: first = step_0 b / D, smoothed = first + step_1 (b - A first) / D, D being
 * the diagonal of A, of which `i` is the inverse. */
GRADUS_FN real8 smoothed_from_zero(CELLS_OF_8, AROUND_8(b), AROUND_8(i), real step_0, real step_1) {
    const real8 image = image_of_8(left, right, up, down, data, b * i, b_left * i_left, b_right * i_right, b_up * i_up,
                                   b_down * i_down);
    return step_0 * (b * i) + step_1 * i * (b - step_0 * image);
}

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

/* Values of 16 pixels from column x on; 0 beyond the grid. */
GRADUS_FN real16 within_grid(real16 values, uint x, uint width) {
    const real16 column = (real16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15) + R(x);
    return column < R(width) ? values : (real16)(R(0));
}

/* The row of coarse pixels on the other side of fine row y from the one that holds it. */
GRADUS_FN uint far_row_of(uint y, uint coarse_height) {
    const uint near_y = y / 2;
    return y % 2 ? min(near_y + 1, coarse_height - 1) : near_y - (near_y > 0 ? 1 : 0);
}

/* What the items of a work-group do in turns: `lanes` items share a line, of which each takes eights of pixels. One
 * item a line is what a CPU reads in order, which does item after item; elsewhere neighbouring items read neighbours.
 */
#define FOR_LINES(count)                                                                                               \
    for (uint line = (uint)get_local_id(0) / lanes; line < (count); line += WORK_GROUP_SIZE / lanes)
#define FOR_EIGHTS(first, end) for (uint eight = (first) + (uint)get_local_id(0) % lanes; eight < (end); eight += lanes)
#define EIGHTS(columns) (((columns) + 7) / 8)

#endif
