/* Variances as weights need them (solver/weighted_reconstruction.h), in two passes: along rows, then columns.
 *
 * A variance that was measured with a few samples is itself noise, and most often too small: what is rare was not met.
 * So it is smoothed, as its fourth root: the mean of variances would be that of the few that are largest, and would
 * take what is sure beside an edge for as unsure as the edge. */
#include "kernels/lib/finite.h"
#include "kernels/solver/grid.h"

#define SMOOTHING_RADIUS 4
/* exp(-d^2 / (2 * 1.5^2)) */
#define SMOOTHING_TAP(d)                                                                                               \
    ((d) == 0 ? R(1) : (d) == 1 ? R(0.8007374) : (d) == 2 ? R(0.4111123) : (d) == 3 ? R(0.1353353) : R(0.0285655))
/* A variance is at least this share of the squared brightness around it: none at all is more often luck. */
#define LEAST_RELATIVE_VARIANCE R(1e-6)
/* And the square root of the least that still is a number of full precision. */
#define LEAST_VARIANCE R(1e-30)

#define PLANE_AT(plane) (((size_t)(plane)*height + y) * width + x)

/* By pixel: the sum of the fourth roots of variances nearby in the row, of their taps, and of brightness. A variance
 * that is missing or below zero counts for nothing, nor do those beyond `edge_columns` and `edge_rows`. */
SOLVE smooth_rows(uint width, uint height, uint edge_columns, uint edge_rows, __global const float *variance,
                  __global const float *primal, __global real *across) {
    const size_t x = get_global_id(0), y = get_global_id(1), pixels = (size_t)width * height;
    if (x >= width)
        return;
    real sum = R(0), weight = R(0), bright = R(0);
    for (int d = -SMOOTHING_RADIUS; d <= SMOOTHING_RADIUS; ++d) {
        const int wanted = (int)x + d;
        const int inside = wanted >= 0 && wanted < (int)width;
        const size_t from = y * width + (size_t)(inside ? wanted : (int)x);
        real v = R(0), b = R(0);
        for (uint c = 0; c < SOLVER_CHANNELS; ++c) {
            v += variance[c * pixels + from];
            b += primal[c * pixels + from];
        }
        const real tap = inside ? SMOOTHING_TAP(d < 0 ? -d : d) : R(0);
        const int known = is_finite(v) && v >= R(0) && wanted < (int)edge_columns && y < edge_rows;
        const real one = known ? tap : R(0);
        sum += one * r_sqrt(r_sqrt(known ? v * R(1.0 / SOLVER_CHANNELS) : R(0)));
        weight += one;
        bright += tap * r_abs(is_finite(b) ? b * R(1.0 / SOLVER_CHANNELS) : R(0));
    }
    across[PLANE_AT(0)] = sum;
    across[PLANE_AT(1)] = weight;
    across[PLANE_AT(2)] = bright;
}

/* The smoothed variance, the same for all channels; -1 where there is none to smooth. */
SOLVE smooth_columns(uint width, uint height, __global const real *across, __global float *smoothed) {
    const size_t x = get_global_id(0), y = get_global_id(1), pixels = (size_t)width * height;
    if (x >= width)
        return;
    real sum = R(0), weight = R(0), bright = R(0), area = R(0);
    for (int d = -SMOOTHING_RADIUS; d <= SMOOTHING_RADIUS; ++d) {
        const int wanted = (int)y + d;
        const int inside = wanted >= 0 && wanted < (int)height;
        const size_t from = (size_t)(inside ? wanted : (int)y) * width + x;
        const real tap = inside ? SMOOTHING_TAP(d < 0 ? -d : d) : R(0);
        sum += tap * across[from];
        weight += tap * across[pixels + from];
        bright += tap * across[2 * pixels + from];
        area += tap;
    }
    /* Brightness has the taps of its row, too. */
    real row_area = R(0);
    for (int d = -SMOOTHING_RADIUS; d <= SMOOTHING_RADIUS; ++d) {
        const int wanted = (int)x + d;
        row_area += wanted >= 0 && wanted < (int)width ? SMOOTHING_TAP(d < 0 ? -d : d) : R(0);
    }
    const real root = sum / (weight > R(0) ? weight : R(1)), squared = root * root;
    const real b = bright / (area * row_area);
    const real v = r_max(squared * squared + LEAST_RELATIVE_VARIANCE * b * b, LEAST_VARIANCE);
    const float value = weight > R(0) ? (float)v : -1.0f;
    for (uint c = 0; c < SOLVER_CHANNELS; ++c)
        smoothed[PLANE_AT(c)] = value;
}

/* mixed = a first + b second; it may be one of them. */
SOLVE mix_images(uint count, real a, real b, __global const float *first, __global const float *second,
                 __global float *mixed) {
    const size_t i = work_item();
    if (i >= count)
        return;
    mixed[i] = a * first[i] + b * second[i];
}
