/* The coarsest grids of a cycle (solver/multigrid.h), down and up again in one launch, a work-group for each channel:
 * they are so small that launches of their own would take longer than what they do. Weights are in memory, whatever
 * those of finer grids are. Columns beyond a grid, up to a multiple of 8, may hold anything finite: their weights are
 * zero. */
#include "kernels/solver/vectors.h"

#define STORED_WEIGHTS                                                                                                 \
    __global const real *weight_x, __global const real *weight_y, __global const real *weight_data,                    \
        __global const real *inverse_diagonal

/* Places on one grid: where the planes of the group's channel begin, and its rows as GRID_LINE takes them. */
#define ON_LEVEL                                                                                                       \
    const uint row = level->row, first = level->values + own * level->plane;                                           \
    const uint first_weight = level->weights + channel * level->weight_plane;

/* smoothed = two steps of smoothing from zero. A single pixel is solved by one. */
GRADUS_FN void smooth_from_zero(__global const solver_level *level, uint own, uint channel, uint lanes, real step_0,
                                real step_1, __global const real *b, __global real *smoothed, STORED_WEIGHTS) {
    ON_LEVEL
    const int is_single = level->width == 1 && level->height == 1;
    FOR_LINES(level->height)
    FOR_EIGHTS(0, EIGHTS(level->width)) {
        const size_t at = first + GRID_LINE(line) + 8 * eight, w = first_weight + GRID_LINE(line) + 8 * eight;
        vstore8(smoothed_from_zero(STORED_CELLS(w), AROUND(b, at, row), AROUND(inverse_diagonal, w, row),
                                   is_single ? R(1) : step_0, is_single ? R(0) : step_1),
                0, smoothed + at);
    }
}

/* to = from + step_size (b - A from) / D. */
GRADUS_FN void smooth_once(__global const solver_level *level, uint own, uint channel, uint lanes, real step_size,
                           __global const real *from, __global real *to, __global const real *b, STORED_WEIGHTS) {
    ON_LEVEL
    FOR_LINES(level->height)
    FOR_EIGHTS(0, EIGHTS(level->width)) {
        const size_t at = first + GRID_LINE(line) + 8 * eight, w = first_weight + GRID_LINE(line) + 8 * eight;
        const real8 residual = vload8(0, b + at) - image_of_8(STORED_CELLS(w), AROUND(from, at, row));
        vstore8(vload8(0, from + at) + step_size * vload8(0, inverse_diagonal + w) * residual, 0, to + at);
    }
}

/* The next grid's right side = the sum of b - A smoothed over 2 x 2 pixels. */
GRADUS_FN void restrict_to(__global const solver_level *next, __global const solver_level *level, uint own,
                           uint channel, uint lanes, __global const real *smoothed, __global real *b, STORED_WEIGHTS) {
    ON_LEVEL
    FOR_LINES(next->height)
    FOR_EIGHTS(0, EIGHTS(next->width)) {
        real8 low = (real8)(R(0)), high = (real8)(R(0));
        for (uint y = 2 * line; y < min(2 * line + 2, level->height); ++y) {
            const size_t at = first + GRID_LINE(y) + 16 * eight, w = first_weight + GRID_LINE(y) + 16 * eight;
            low += vload8(0, b + at) - image_of_8(STORED_CELLS(w), AROUND(smoothed, at, row));
            high += vload8(0, b + at + 8) - image_of_8(STORED_CELLS(w + 8), AROUND(smoothed, at + 8, row));
        }
        vstore8(EVEN(low, high) + ODD(low, high), 0,
                b + next->values + own * next->plane + (line + 1) * next->row + SOLVER_MARGIN + 8 * eight);
    }
}

/* smoothed += the interpolated next grid; 0 beyond the grid. */
GRADUS_FN void prolong_from(__global const solver_level *next, __global const solver_level *level, uint own, uint lanes,
                            __global real *smoothed) {
    const uint row = level->row, first = level->values + own * level->plane;
    FOR_LINES(level->height)
    FOR_EIGHTS(0, EIGHTS(next->width)) {
        const uint x = 8 * eight, last = next->width - 1 - x;
        __global const real *coarse = smoothed + next->values + own * next->plane + SOLVER_MARGIN + x;
        const real8 left_inside = (real8)(R(x != 0), 1, 1, 1, 1, 1, 1, 1);
        const real8 right_inside = (real8)(R(last != 0), R(last != 1), R(last != 2), R(last != 3), R(last != 4),
                                           R(last != 5), R(last != 6), R(last != 7));
        const uint at = first + GRID_LINE(line) + 2 * x;
        const real16 added =
            interpolated(coarse + (line / 2 + 1) * next->row, coarse + (far_row_of(line, next->height) + 1) * next->row,
                         left_inside, right_inside);
        vstore16(within_grid(vload16(0, smoothed + at) + added, 2 * x, level->width), 0, smoothed + at);
    }
}

#define EVERY_ITEM_DONE barrier(CLK_GLOBAL_MEM_FENCE);
#define WEIGHTS_HERE weight_x, weight_y, weight_data, inverse_diagonal
SOLVE coarse_cycle(uint first_channel, uint level_count, uint lanes, real step_0, real step_1,
                   __global const solver_level *levels, __global real *right_side, __global real *smoothed,
                   __global real *other, STORED_WEIGHTS) {
    const uint own = (uint)get_group_id(0), channel = first_channel + own, last = level_count - 1;
    for (uint i = 0; i < last; ++i) {
        smooth_from_zero(levels + i, own, channel, lanes, step_0, step_1, right_side, smoothed, WEIGHTS_HERE);
        EVERY_ITEM_DONE
        restrict_to(levels + i + 1, levels + i, own, channel, lanes, smoothed, right_side, WEIGHTS_HERE);
        EVERY_ITEM_DONE
    }
    smooth_from_zero(levels + last, own, channel, lanes, step_0, step_1, right_side, smoothed, WEIGHTS_HERE);
    EVERY_ITEM_DONE
    for (uint i = last; i > 0; --i) {
        __global const solver_level *level = levels + i - 1;
        prolong_from(levels + i, level, own, lanes, smoothed);
        EVERY_ITEM_DONE
        smooth_once(level, own, channel, lanes, step_1, smoothed, other, right_side, WEIGHTS_HERE);
        EVERY_ITEM_DONE
        smooth_once(level, own, channel, lanes, step_0, other, smoothed, right_side, WEIGHTS_HERE);
        EVERY_ITEM_DONE
    }
}
