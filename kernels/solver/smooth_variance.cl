/* Variances as weights need them (solver/weighted_reconstruction.h).
 *
 * A variance that was measured with a few samples is itself noise, and most often too small: what is rare was not met.
 * Smoothed over a few pixels it knows too little, over many it takes what is sure beside an edge for as unsure as the
 * edge. So it is smoothed by several widths, each from the one before (a trous: Holschneider et al. 1989), and the
 * geometric mean of all is taken. */
#include "kernels/lib/approximation.h"
#include "kernels/lib/finite.h"
#include "kernels/solver/grid.h"

/* The least variance: its logarithm is a number, and so is what it is divided by. */
#define LEAST_VARIANCE R(1e-30)

/* The mean over the channels, -1 where it is missing: NaN, infinite, (of variances) below zero, or beyond `columns` and
 * `rows`, which are all that the image has. */
SOLVE mean_of_channels(GRID, uint columns, uint rows, uint is_variance, __global const float *packed,
                       __global real *mean) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const bool inside = x < columns && y < rows;
    real sum = R(0);
#pragma unroll
    for (uint c = 0; c < SOLVER_CHANNELS; ++c)
        sum += inside ? packed[PACKED_AT(c)] : 0.0f;
    const int is_there = inside && is_finite(sum) && (sum >= R(0) || !is_variance);
    mean[GRID_AT(0, x, y)] = is_there ? r_abs(sum) * R(1.0 / SOLVER_CHANNELS) : R(-1);
}

/* The mean of `image` and of its neighbours `apart` pixels away (at most SOLVER_MARGIN), which count `side` beside it,
 * at the corners side^2; -1 where none of them is there, and beyond `columns` and `rows`. What is missing is -1, in the
 * border too; so a sum takes one comparison a value. */
#define NEIGHBOURS uint columns, uint rows, uint apart, real side, __global const real *image
typedef struct {
    real values, count;
    GRADUS_NOT_IN_REGISTERS
} present_values;
#define ADD_PRESENT(sum, value)                                                                                        \
    {                                                                                                                  \
        const real added = value;                                                                                      \
        sum.values += r_max(added, R(0));                                                                              \
        sum.count += added >= R(0) ? R(1) : R(0);                                                                      \
    }
GRADUS_FN real mean_of_neighbours(size_t x, size_t y, uint row, NEIGHBOURS) {
    present_values here = {R(0), R(0)}, sides = {R(0), R(0)}, corners = {R(0), R(0)};
    /* The same for all work-items of a group, or they would gather. */
    __global const real *line = image + GRID_LINE(y);
    __global const real *above = image + GRID_LINE(y >= apart ? y - apart : (size_t)-1);
    __global const real *below = image + GRID_LINE(y + apart < rows ? y + apart : (size_t)-1);
    const size_t left = x - apart, right = x + apart;
    ADD_PRESENT(here, line[x])
    ADD_PRESENT(sides, line[left])
    ADD_PRESENT(sides, line[right])
    ADD_PRESENT(sides, above[x])
    ADD_PRESENT(sides, below[x])
    ADD_PRESENT(corners, above[left])
    ADD_PRESENT(corners, above[right])
    ADD_PRESENT(corners, below[left])
    ADD_PRESENT(corners, below[right])
    const real sum = here.values + side * (sides.values + side * corners.values);
    const real weight = here.count + side * (sides.count + side * corners.count);
    const int is_there = (x < columns) & (y < rows) & (weight > R(0));
    return is_there ? sum / weight : R(-1);
}

SOLVE smooth_image(GRID, NEIGHBOURS, __global real *smoothed) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    smoothed[GRID_AT(0, x, y)] = mean_of_neighbours(x, y, row, columns, rows, apart, side, image);
}

/* The same; and logarithms += share log(smoothed), `before` being the shares so far. What is there for the first time
 * counts for those, too. A variance is at least `least` times the squared brightness. */
SOLVE smooth_and_add(GRID, NEIGHBOURS, real share, real before, real least, __global const real *brightness,
                     __global real *smoothed, __global real *logarithms) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const size_t at = GRID_AT(0, x, y);
    const real v = mean_of_neighbours(x, y, row, columns, rows, apart, side, image);
    const real b = r_max(brightness[at], R(0));
    const real logarithm = approx_log(r_max(v, R(0)) + least * b * b + LEAST_VARIANCE);
    const int is_first = (image[at] < R(0)) | (before == R(0));
    smoothed[at] = v;
    logarithms[at] = is_first ? (before + share) * logarithm : logarithms[at] + share * logarithm;
}

/* The geometric mean, `share` being one over the shares of all; -1 where nothing was there. */
SOLVE geometric_mean(GRID, real share, __global const real *smoothed, __global const real *logarithms,
                     __global float *packed) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const size_t at = GRID_AT(0, x, y);
    const float value = smoothed[at] >= R(0) ? (float)approx_exp(share * logarithms[at]) : -1.0f;
    if (x < width)
        packed[PACKED_AT(0)] = value;
}

/* mixed = a first + b second; it may be one of them. */
SOLVE mix_images(uint count, real a, real b, __global const float *first, __global const float *second,
                 __global float *mixed) {
    const size_t i = work_item();
    if (i >= count)
        return;
    mixed[i] = a * first[i] + b * second[i];
}
