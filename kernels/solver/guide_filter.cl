/* The feature filter (solver/guide/feature_filter.h): for one row of neighbours, `down` - GUIDE_RADIUS below, in a band
 * of the image's rows. */
#include "kernels/lib/approximation.h"
#include "kernels/lib/ordered.h"
#include "kernels/shared/guide_shared.h"
#include "kernels/solver/grid.h"

/* Distances as large as this have no weight; infinite ones would be NaN times zero. */
#define LARGEST_DISTANCE R(1e4)

/* The row of the padded plane that lies `down` below row `line` (both count the border's), or one of zeros. */
#define NEIGHBOUR_LINE(line)                                                                                           \
    ((int)(line) + (int)down - GUIDE_RADIUS < 0                 ? 0                                                    \
     : (int)(line) + (int)down - GUIDE_RADIUS > (int)height + 1 ? (int)height + 1                                      \
                                                                : (int)(line) + (int)down - GUIDE_RADIUS)
#define BAND_AT(across, line) ((size_t)(across)*band_plane + (size_t)(line)*row + SOLVER_MARGIN + x)

/* By pixel and neighbour: how far their means differ, in units of what noise makes them differ, less what it makes
 * them differ on average: the mean over the channels. From the row above the band to the one below. */
SOLVE guide_distances(GRID, uint down, uint band_plane, __global const real *images, __global const real *certainty,
                      __global real *distances) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const size_t line = get_group_id(1);
    const size_t here = y * row + SOLVER_MARGIN + x, there = (size_t)NEIGHBOUR_LINE(y) * row + SOLVER_MARGIN + x;
    const bool counts = certainty[GUIDE_TRUST * (size_t)plane + here] > R(0);
#pragma unroll
    for (int across = -GUIDE_RADIUS; across <= GUIDE_RADIUS; ++across) {
        const bool both = counts && certainty[GUIDE_TRUST * (size_t)plane + there + across] > R(0);
        real sum = R(0);
#pragma unroll
        for (uint c = 0; c < 3; ++c) {
            const real a = images[(GUIDE_MEAN + c) * (size_t)plane + here];
            const real b = images[(GUIDE_MEAN + c) * (size_t)plane + there + across];
            const real va = certainty[(GUIDE_VARIANCE + c) * (size_t)plane + here];
            const real vb = certainty[(GUIDE_VARIANCE + c) * (size_t)plane + there + across];
            const real difference = r_after(a - b, sum);
            const real both_noises = va + vb;
            const real distance = (difference * difference - (va + r_min(va, vb))) / (both ? both_noises : R(1));
            sum += r_min(distance, LARGEST_DISTANCE);
        }
        distances[BAND_AT(across + GUIDE_RADIUS, line)] = both ? sum * R(1.0 / 3) : R(0);
    }
}

/* Adds what the row's neighbours weigh: by the distance of the patches of 3 x 3 pixels around both, by that of the
 * feature that differs most, and by the trust in the neighbour. `row_share` times `column_share`: one over how many
 * pixels of the patches are inside of the image. */
SOLVE guide_gather(GRID, uint down, uint unit, uint band_plane, __global const real *images,
                   __global const real *certainty, __global const real *features, __global const real *distances,
                   __global const real *column_share, __global const real *row_share, __global real *sums) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const size_t line = get_group_id(1);
    const size_t here = (y + 1) * row + SOLVER_MARGIN + x;
    const size_t there = (size_t)NEIGHBOUR_LINE(y + 1) * row + SOLVER_MARGIN + x;
    /* `unit` is 1: loads that are known to be neighbours are joined (docs/design.md). */
    const real row_part = row_share[down * height + y];
    real sum[GUIDE_SUMS];
#pragma unroll
    for (uint k = 0; k < GUIDE_SUMS; ++k) {
        const real before = sums[k * (size_t)plane + here];
        sum[k] = down == 0 ? R(0) : before;
    }
#pragma unroll
    for (int across = -GUIDE_RADIUS; across <= GUIDE_RADIUS; ++across) {
        const size_t neighbour = there + (size_t)(across + GUIDE_RADIUS) * unit - GUIDE_RADIUS;
        real patch = R(0);
#pragma unroll
        for (int v = 0; v < 3; ++v)
#pragma unroll
            for (int u = -1; u <= 1; ++u)
                patch += distances[BAND_AT(across + GUIDE_RADIUS, line + v) + (size_t)(u + 1) * unit - 1];
        patch *= row_part * column_share[(size_t)(across + GUIDE_RADIUS) * row + x];
        real apart = R(0);
#pragma unroll
        for (uint c = 0; c < GUIDE_FEATURES; ++c) {
            const real difference = features[c * (size_t)plane + here] - features[c * (size_t)plane + neighbour];
            apart = r_max(apart, difference * difference);
        }
        real weight = approx_exp(-(r_max(patch, R(0)) + apart)) * certainty[GUIDE_TRUST * (size_t)plane + neighbour];
        sum[GUIDE_WEIGHT] += weight;
#pragma unroll
        for (uint k = 0; k < GUIDE_WEIGHT; ++k) {
            sum[k] += weight * images[(GUIDE_FIRST + k) * (size_t)plane + neighbour];
            weight = r_after(weight, sum[k]);
        }
    }
#pragma unroll
    for (uint k = 0; k < GUIDE_SUMS; ++k)
        sums[k * (size_t)plane + here] = sum[k];
}

/* The weighted means of both halves, 0 where no neighbour counts. */
SOLVE guide_export(GRID, __global const real *sums, __global float *first_guide, __global float *second_guide) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const real weight = sums[GRID_AT(GUIDE_WEIGHT, x, y)];
    const real scale = weight > R(0) ? R(1) / weight : R(0);
    if (x >= width)
        return;
#pragma unroll
    for (uint c = 0; c < 3; ++c) {
        const size_t packed = ((size_t)c * height + y) * width + x;
        first_guide[packed] = (float)(sums[GRID_AT(c, x, y)] * scale);
        second_guide[packed] = (float)(sums[GRID_AT(3 + c, x, y)] * scale);
    }
}
