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

/* What the items of the group do in turns: eights of pixels, in rows of so many. */
#define FOR_EIGHTS(columns, rows)                                                                                      \
    const uint across = ((columns) + 7) / 8;                                                                           \
    for (uint eight = (uint)get_local_id(0); eight < across * (rows); eight += WORK_GROUP_SIZE)
#define EIGHT_PLACE const uint x = eight % across * 8, y = eight / across;

#define EVERY_ITEM_DONE barrier(CLK_GLOBAL_MEM_FENCE);

/* smoothed = two steps of smoothing from zero, as by smooth_twice_from_zero. A single pixel is solved by one. */
GRADUS_FN void smooth_from_zero(__global const solver_level *level, uint own, uint channel, real step_0, real step_1,
                                __global const real *b, __global real *smoothed, STORED_WEIGHTS) {
    ON_LEVEL
    const int is_single = level->width == 1 && level->height == 1;
    const real first_step = is_single ? R(1) : step_0, second_step = is_single ? R(0) : step_1;
    __global const real *inverse = inverse_diagonal;
    FOR_EIGHTS(level->width, level->height) {
        EIGHT_PLACE
        const uint at = first + GRID_LINE(y) + x, w = first_weight + GRID_LINE(y) + x;
        const real8 inverse_here = vload8(0, inverse + w), right_side_here = vload8(0, b + at);
        const real8 here = right_side_here * inverse_here;
        const real8 left = vload8(0, b + at - 1) * vload8(0, inverse + w - 1);
        const real8 right = vload8(0, b + at + 1) * vload8(0, inverse + w + 1);
        const real8 up = vload8(0, b + at - row) * vload8(0, inverse + w - row);
        const real8 down = vload8(0, b + at + row) * vload8(0, inverse + w + row);
        const real8 image = vload8(0, weight_data + w) * here +
                            (vload8(0, weight_x + w - 1) * (here - left) + vload8(0, weight_x + w) * (here - right)) +
                            (vload8(0, weight_y + w - row) * (here - up) + vload8(0, weight_y + w) * (here - down));
        vstore8(first_step * here + second_step * inverse_here * (right_side_here - first_step * image), 0,
                smoothed + at);
    }
}

/* to = from + step_size (right_side - A from) / D. */
GRADUS_FN void smooth_once(__global const solver_level *level, uint own, uint channel, real step_size,
                           __global const real *from, __global real *to, __global const real *right_side,
                           STORED_WEIGHTS) {
    ON_LEVEL
    FOR_EIGHTS(level->width, level->height) {
        EIGHT_PLACE
        const uint at = first + GRID_LINE(y) + x, w = first_weight + GRID_LINE(y) + x;
        vstore8(vload8(0, from + at) + step_size * vload8(0, inverse_diagonal + w) *
                                           residual_of_8(STORED_CELLS(w), from, right_side, at, row),
                0, to + at);
    }
}

/* The next grid's right side = the sum of right_side - A smoothed over 2 x 2 pixels. */
GRADUS_FN void restrict_to(__global const solver_level *next, __global const solver_level *level, uint own,
                           uint channel, __global const real *smoothed, __global real *right_side, STORED_WEIGHTS) {
    ON_LEVEL
    FOR_EIGHTS(next->width, next->height) {
        EIGHT_PLACE
        const uint at = first + GRID_LINE(2 * y) + 2 * x, w = first_weight + GRID_LINE(2 * y) + 2 * x;
        real8 low = residual_of_8(STORED_CELLS(w), smoothed, right_side, at, row);
        real8 high = residual_of_8(STORED_CELLS(w + 8), smoothed, right_side, at + 8, row);
        if (2 * y + 1 < level->height) {
            const uint below = at + row, w_below = w + row;
            low += residual_of_8(STORED_CELLS(w_below), smoothed, right_side, below, row);
            high += residual_of_8(STORED_CELLS(w_below + 8), smoothed, right_side, below + 8, row);
        }
        const uint to = next->values + own * next->plane + (y + 1) * next->row + SOLVER_MARGIN + x;
        vstore8(EVEN(low, high) + ODD(low, high), 0, right_side + to);
    }
}

/* smoothed += the interpolated next level-> */
GRADUS_FN void prolong_from(__global const solver_level *next, __global const solver_level *level, uint own,
                            __global real *smoothed) {
    const uint channel = 0; /* no weights here */
    ON_LEVEL(void) first_weight;
    FOR_EIGHTS(next->width, level->height) {
        EIGHT_PLACE
        __global const real *coarse = smoothed + next->values + own * next->plane + SOLVER_MARGIN + x;
        const uint last = next->width - 1 - x;
        const real8 left_inside = (real8)(R(x != 0), 1, 1, 1, 1, 1, 1, 1);
        const real8 right_inside = (real8)(R(last != 0), R(last != 1), R(last != 2), R(last != 3), R(last != 4),
                                           R(last != 5), R(last != 6), R(last != 7));
        const uint at = first + GRID_LINE(y) + 2 * x;
        vstore16(vload16(0, smoothed + at) + interpolated(coarse + (y / 2 + 1) * next->row,
                                                          coarse + (far_row_of(y, next->height) + 1) * next->row,
                                                          left_inside, right_inside),
                 0, smoothed + at);
    }
}

#define WEIGHTS_HERE weight_x, weight_y, weight_data, inverse_diagonal
SOLVE coarse_cycle(uint first_channel, uint level_count, real step_0, real step_1, __global const solver_level *levels,
                   __global real *right_side, __global real *smoothed, __global real *other, STORED_WEIGHTS) {
    const uint own = (uint)get_group_id(0), channel = first_channel + own, last = level_count - 1;
    for (uint i = 0; i < last; ++i) {
        smooth_from_zero(levels + i, own, channel, step_0, step_1, right_side, smoothed, WEIGHTS_HERE);
        EVERY_ITEM_DONE
        restrict_to(levels + i + 1, levels + i, own, channel, smoothed, right_side, WEIGHTS_HERE);
        EVERY_ITEM_DONE
    }
    smooth_from_zero(levels + last, own, channel, step_0, step_1, right_side, smoothed, WEIGHTS_HERE);
    EVERY_ITEM_DONE
    for (uint i = last; i > 0; --i) {
        prolong_from(levels + i, levels + i - 1, own, smoothed);
        EVERY_ITEM_DONE
        /* In the other order than on the way down. */
        smooth_once(levels + i - 1, own, channel, step_1, smoothed, other, right_side, WEIGHTS_HERE);
        EVERY_ITEM_DONE
        smooth_once(levels + i - 1, own, channel, step_0, other, smoothed, right_side, WEIGHTS_HERE);
        EVERY_ITEM_DONE
    }
}
