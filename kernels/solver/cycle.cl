/* What a cycle (solver/multigrid.h) does on one grid, tile by tile, a work-group each: what the first step leaves for
 * the second stays in local memory, and goes to memory once or never. A tile's border, a row above and below and 8
 * columns on each side, is computed by its neighbours, too. LOCAL_REALS is what a tile has (solver/tiles.h). */
#include "kernels/solver/tiles.h"

/* Where the tile's own row y lies in local memory, whose rows are local_row apart; -1 is that of its border. */
#define LOCAL_LINE(y) (((y) + 1) * local_row + 8)

/* The eights of a line of the tile with its border, from the one left of it on, that have pixels in the grid. */
#define FIRST_INSIDE (first_x > 0 ? 0 : 1)
#define END_INSIDE (1 + EIGHTS(min(columns + 8, width - first_x)))

/* Zeros for what of a tile's border is not in the grid: its weights are zero, but it must be finite. */
GRADUS_FN void clear_outside(__local real *tile, uint line, uint local_row, int is_inside, uint first, uint end,
                             uint lanes) {
    const real8 nothing = (real8)(R(0));
    const uint across = local_row / 8;
    FOR_EIGHTS(0, is_inside ? first : across) { vstore8(nothing, 0, tile + line * local_row + 8 * eight); }
    FOR_EIGHTS(end, is_inside ? across : end) { vstore8(nothing, 0, tile + line * local_row + 8 * eight); }
}

#define STEP_DONE barrier(CLK_LOCAL_MEM_FENCE);

/* A line of the tile or of its border. */
#define LINE_WITH_BORDER                                                                                               \
    const uint y = first_y + line - 1; /* wraps around above the grid */                                               \
    const int is_inside = y < height;                                                                                  \
    clear_outside(tile, line, local_row, is_inside, FIRST_INSIDE, END_INSIDE, lanes);                                  \
    ON_LINE
#define FOR_EIGHTS_WITH_BORDER FOR_EIGHTS(FIRST_INSIDE, is_inside ? END_INSIDE : 0)

/* smoothed = two steps of smoothing from zero; coarse = the sum of right_side - A smoothed over 2 x 2 pixels. */
SOLVE descend(TILED_GRID, uint coarse_row, uint coarse_plane, WEIGHTS, real step_0, real step_1,
              __global const real *right_side, __global real *smoothed, __global real *coarse) {
    __local real tile[LOCAL_REALS];
    TILE_PLACE
    const uint local_row = tile_columns + 16;
    FOR_LINES(rows + 2) {
        LINE_WITH_BORDER
        FOR_EIGHTS_WITH_BORDER {
            const size_t x = first_x + 8 * eight - 8;
            const real8 value = smoothed_from_zero(CELLS(x, y), AROUND(right_side, line_at + x, row),
                                                   AROUND(inverse_diagonal, line_weight + x, row), step_0, step_1);
            vstore8(value, 0, tile + LOCAL_LINE(line - 1) + 8 * eight - 8);
            if (line - 1 < rows && eight - 1 < EIGHTS(columns))
                vstore8(value, 0, smoothed + line_at + x);
        }
    }
    STEP_DONE
    FOR_LINES((rows + 1) / 2) {
        FOR_EIGHTS(0, EIGHTS((columns + 1) / 2)) {
            const size_t x = first_x + 16 * eight;
            real8 low = (real8)(R(0)), high = (real8)(R(0));
            for (uint y = first_y + 2 * line; y < min(first_y + 2 * line + 2, height); ++y) {
                ON_LINE
                const uint from = LOCAL_LINE(y - first_y) + 16 * eight;
                low += vload8(0, right_side + line_at + x) - image_of_8(CELLS(x, y), AROUND(tile, from, local_row));
                high += vload8(0, right_side + line_at + x + 8) -
                        image_of_8(CELLS(x + 8, y), AROUND(tile, from + 8, local_row));
            }
            vstore8(EVEN(low, high) + ODD(low, high), 0,
                    coarse + own * coarse_plane + (first_y / 2 + line + 1) * coarse_row + SOLVER_MARGIN + x / 2);
        }
    }
}

/* smoothed = two steps of smoothing from u, in the other order than on the way down; or smoothed += these. With
 * `multiplies`, also the parts of <smoothed, right_side> and of <smoothed, image>. */
SOLVE ascend(TILED_GRID, WEIGHTS, real step_0, real step_1, uint adds, uint multiplies, uint partials,
             __global const real *right_side, __global const real *u, __global const real *image,
             __global real *smoothed, __global real *partial) {
    __local real tile[LOCAL_REALS];
    TILE_PLACE
    const uint local_row = tile_columns + 16;
    FOR_LINES(rows + 2) {
        LINE_WITH_BORDER
        FOR_EIGHTS_WITH_BORDER {
            const size_t x = first_x + 8 * eight - 8, at = line_at + x;
            const real8 residual = vload8(0, right_side + at) - image_of_8(CELLS(x, y), AROUND(u, at, row));
            vstore8(vload8(0, u + at) + step_1 * vload8(0, inverse_diagonal + line_weight + x) * residual, 0,
                    tile + LOCAL_LINE(line - 1) + 8 * eight - 8);
        }
    }
    STEP_DONE
    FOR_LINES(rows) {
        const uint y = first_y + line;
        ON_LINE
        FOR_EIGHTS(0, EIGHTS(columns)) {
            const size_t x = first_x + 8 * eight, at = line_at + x;
            const uint from = LOCAL_LINE(line) + 8 * eight;
            const real8 b = vload8(0, right_side + at);
            const real8 residual = b - image_of_8(CELLS(x, y), AROUND(tile, from, local_row));
            const real8 value =
                vload8(0, tile + from) + step_0 * vload8(0, inverse_diagonal + line_weight + x) * residual;
            vstore8(adds ? vload8(0, smoothed + at) + value : value, 0, smoothed + at);
            if (multiplies) {
                const real8 with_right_side = value * b, with_image = value * vload8(0, image + at);
                partial[TILE_PARTIAL(0, x, y)] = SUM_OF_8(with_right_side);
                partial[TILE_PARTIAL(1, x, y)] = SUM_OF_8(with_image);
            }
        }
    }
}
