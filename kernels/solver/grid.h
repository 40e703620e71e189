/* The grids of the solver, and its five-point operator.
 *
 * A grid is a plane for each channel, each with a border of one row and SOLVER_MARGIN columns of zeros, so that a
 * stencil needs no branch at the edges of the image. Rows are `row` elements apart, planes `plane` elements.
 * A work-group is SOLVER_TILE columns of one row in one channel. All columns up to
 * a multiple of SOLVER_TILE are computed, and there everything is zero: a branch at the right edge would cost more
 * (PoCL then divides in each lane to find the row).
 *
 * The operator is A u = data u - div(edge grad u), with free borders: each edge between two pixels has a weight, and so
 * has each pixel. Without SOLVER_WEIGHTED they are products: of an edge between columns (1, or 0 at the last) and the
 * size of a row, and so on. Sizes are 1 but for the last column and row of a coarse grid, which may stand for fewer
 * pixels than the others. */
#ifndef GRADUS_SOLVER_GRID_H
#define GRADUS_SOLVER_GRID_H
//! traits: SOLVER_CHANNELS SOLVER_WEIGHTED SOLVER_JOINT
#include "kernels/lib/compensated.h"
#include "kernels/shared/solver_shared.h"

#ifdef GRADUS_DOUBLE
#define real8 double8
#define real16 double16
#else
#define real8 float8
#define real16 float16
#endif

#define SOLVE __attribute__((reqd_work_group_size(WORK_GROUP_SIZE, 1, 1))) __kernel void

/* A grid as kernel arguments, the first channel and row of a launch, and where a pixel lies. */
#define GRID uint width, uint height, uint row, uint plane, uint first_channel, uint first_row
#define GRID_LINE(y) (((y) + 1) * row + SOLVER_MARGIN)
#define GRID_AT(channel, x, y) ((channel)*plane + GRID_LINE(y) + (x))
#define OWN_AT(x, y) GRID_AT(own, x, y)
/* Where pixel x, y lies in the caller's planes: contiguous even where it is not inside and must not be read. */
#define PACKED_AT(channel) (((size_t)(channel)*height + y) * width + x)

/* Defines the channel and the pixel of a work-item: channels first_channel and on take turns row by row. `own` counts
 * from first_channel: buffers of one group of channels alone (solver/workspace.h) begin there, OWN_AT. */
#define SOLVER_PLACE                                                                                                   \
    const uint group = (uint)get_group_id(0);                                                                          \
    const uint tiles = (width + SOLVER_TILE - 1) / SOLVER_TILE;                                                        \
    const size_t y = first_row + get_group_id(1);                                                                      \
    const size_t own = group / tiles, channel = first_channel + own;                                                   \
    const size_t item = get_local_id(0), x = group % tiles * SOLVER_TILE + item;                                       \
    const size_t tile = y * tiles + group % tiles;

/* Weights have a plane for all channels, or one for each. Where `channel` counts the planes of weights, the channels
 * that share one are CHANNELS_TOGETHER from FIRST_CHANNEL on. */
#if SOLVER_WEIGHTED && !SOLVER_JOINT
#define SOLVER_WEIGHT_PLANES SOLVER_CHANNELS
#define FIRST_CHANNEL channel
#define CHANNELS_TOGETHER 1
#else
#define SOLVER_WEIGHT_PLANES 1
#define FIRST_CHANNEL 0
#define CHANNELS_TOGETHER SOLVER_CHANNELS
#endif

/* Where the item's part of a sum goes: `partials` parts for each channel of the kernel's first sum, then of the next.
 */
#define SOLVER_PARTIAL(sum) (((sum)*SOLVER_CHANNELS + channel) * partials + tile * SOLVER_TILE + item)

/* Kernels that do all channels of a pixel in one item are launched on one plane. */
#define SOLVER_PLACE_OF_ALL_CHANNELS                                                                                   \
    const uint group = (uint)get_group_id(0);                                                                          \
    const uint tiles = (width + SOLVER_TILE - 1) / SOLVER_TILE;                                                        \
    const size_t item = get_local_id(0), x = group * SOLVER_TILE + item;                                               \
    const size_t y = first_row + get_group_id(1), tile = y * tiles + group;

/* A scalar that another kernel left, and a quotient of two of them, 0 where the divisor is next to nothing: a sum of
 * squares of which most underflowed. */
#define SCALAR(slot) scalars[channel * SOLVER_SCALAR_SLOTS + (slot)]
#define SCALAR_RATIO(a, b) (SCALAR(a) / (r_abs(SCALAR(b)) > R(1e-33) ? SCALAR(b) : R(1e38)))

/* factor times a value; 0 where the factor is, which says that the value is none of this solve's. */
#define TIMES_IF_ANY(factor, value) ((factor) == R(0) ? R(0) : (factor) * (value))

/* The weights, as kernel arguments. */
#if SOLVER_WEIGHTED
#define WEIGHTS_OF_DIAGONAL                                                                                            \
    __global const real *weight_x, __global const real *weight_y, __global const real *weight_data, uint weight_plane
#define WEIGHT_AT(x, y) (channel * weight_plane + ((y) + 1) * row + SOLVER_MARGIN + (x))
#else
#define WEIGHTS_OF_DIAGONAL                                                                                            \
    real data, __global const real *column_left, __global const real *column_right, __global const real *column_size,  \
        __global const real *row_up, __global const real *row_down, __global const real *row_size
#define WEIGHT_AT(x, y) (((y) + 1) * row + SOLVER_MARGIN + (x))
#endif

#define WEIGHTS WEIGHTS_OF_DIAGONAL, __global const real *inverse_diagonal

typedef struct {
    real left, right, up, down, data;
    GRADUS_NOT_IN_REGISTERS
} cell_weights;

#if SOLVER_WEIGHTED
#define CELL(x, y) cell_at(weight_x, weight_y, weight_data, WEIGHT_AT(x, y), row)
GRADUS_FN cell_weights cell_at(__global const real *weight_x, __global const real *weight_y,
                               __global const real *weight_data, size_t at, uint row) {
    cell_weights c;
    c.left = weight_x[at - 1];
    c.right = weight_x[at];
    c.up = weight_y[at - row];
    c.down = weight_y[at];
    c.data = weight_data[at];
    return c;
}
#else
/* Edges on both sides come from arrays of their own: where two loads are neighbours, the compiler joins them, and then
 * does not vectorise over work-items. */
#define CELL(x, y) cell_at(data, column_left[x], column_right[x], column_size[x], row_up[y], row_down[y], row_size[y])
GRADUS_FN cell_weights cell_at(real data, real left, real right, real wide, real up, real down, real high) {
    cell_weights c;
    c.left = left * high;
    c.right = right * high;
    c.up = up * wide;
    c.down = down * wide;
    c.data = data * wide * high;
    return c;
}
#endif

/* (A u) at one place. */
GRADUS_FN real operator_at(cell_weights c, __global const real *u, size_t at, uint row) {
    const real here = u[at];
    return c.data * here + (c.left * (here - u[at - 1]) + c.right * (here - u[at + 1])) +
           (c.up * (here - u[at - row]) + c.down * (here - u[at + row]));
}

#define RESIDUAL(x, y) (right_side[OWN_AT(x, y)] - operator_at(CELL(x, y), u, OWN_AT(x, y), row))

#endif
