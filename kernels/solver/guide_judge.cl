/* How far a guide is followed, by place (solver/guide/guide_judge.h). */
#include "kernels/lib/finite.h"
#include "kernels/shared/guide_shared.h"
#include "kernels/solver/grid.h"

#define JUDGED                                                                                                         \
    real share, __global const float *first_half, __global const float *second_half,                                   \
        __global const float *first_guide, __global const float *second_guide

/* Whether all twelve values of a pixel are there. */
#define ALL_THERE(there)                                                                                               \
    uint there##_missing = 0;                                                                                          \
    _Pragma("unroll") for (uint c = 0; c < 3; ++c) there##_missing |=                                                  \
        (is_finite(inside ? first_half[PACKED_AT(c)] : 0.0f) ? 0 : 1) |                                                \
        (is_finite(inside ? second_half[PACKED_AT(c)] : 0.0f) ? 0 : 1) |                                               \
        (is_finite(inside ? first_guide[PACKED_AT(c)] : 0.0f) ? 0 : 1) |                                               \
        (is_finite(inside ? second_guide[PACKED_AT(c)] : 0.0f) ? 0 : 1);                                               \
    const bool there = inside && there##_missing == 0;

/* By pixel, relative to its squared brightness: GUIDE_GAIN, an estimate of the variance of the mean of the halves less
 * its covariance with the guide's; GUIDE_LOSS, one of the guide's mean square error less that covariance. */
SOLVE guide_moments(GRID, JUDGED, real least_brightness, __global real *moments, __global real *shares) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const bool inside = x < width;
    ALL_THERE(counts)
    const real rest = R(1) - share;
    real gain = R(0), apart = R(0), bright = R(0);
#pragma unroll
    for (uint c = 0; c < 3; ++c) {
        const real a = counts ? first_half[PACKED_AT(c)] : 0.0f, b = counts ? second_half[PACKED_AT(c)] : 0.0f;
        const real guide_a = counts ? first_guide[PACKED_AT(c)] : 0.0f;
        const real guide_b = counts ? second_guide[PACKED_AT(c)] : 0.0f;
        const real guide = share * guide_a + rest * guide_b, difference = guide - (share * a + rest * b);
        gain += share * rest * (a - b) * ((a - b) - (guide_a - guide_b));
        apart += difference * difference;
        bright += guide;
    }
    bright *= R(1.0 / 3);
    const real scale = R(1.0 / 3) / (bright * bright + least_brightness);
    const real loss = scale * (apart - gain);
    moments[GRID_AT(GUIDE_GAIN, x, y)] = scale * gain;
    moments[GRID_AT(GUIDE_LOSS, x, y)] = loss;
    moments[GRID_AT(GUIDE_SQUARE, x, y)] = loss * loss;
    shares[GRID_AT(GUIDE_COUNTS, x, y)] = counts ? R(1) : R(0);
}

/* The share of the guide with the least error, its loss less one standard error: what is not significant is none. The
 * moments are sums over a neighbourhood, with weights whose squares sum to half of their sum. */
SOLVE guide_share(GRID, __global const real *moments, __global real *shares) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const real gain = r_max(moments[GRID_AT(GUIDE_GAIN, x, y)], R(0));
    const real error = r_sqrt(R(0.5) * r_max(moments[GRID_AT(GUIDE_SQUARE, x, y)], R(0)));
    const real loss = r_max(moments[GRID_AT(GUIDE_LOSS, x, y)] - error, R(0));
    const real sum = gain + loss;
    const real best = sum > R(0) ? gain / (sum > R(0) ? sum : R(1)) : R(0);
    shares[GRID_AT(GUIDE_SHARE, x, y)] = best * shares[GRID_AT(GUIDE_COUNTS, x, y)];
}

/* The mean of the halves and of the guides, by the smoothed share. Where one of them is missing, the other; 0 where
 * both are. */
SOLVE guide_blend(GRID, JUDGED, __global const real *smoothed, __global float *result) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const bool inside = x < width;
    const real area = smoothed[GRID_AT(GUIDE_COUNTS, x, y)];
    const real follow = area > R(0) ? smoothed[GRID_AT(GUIDE_SHARE, x, y)] / area : R(0);
    const real rest = R(1) - share;
    /* A sum is finite where all its parts are. */
    float of_images = 0, of_guides = 0;
#pragma unroll
    for (uint c = 0; c < 3; ++c) {
        of_images += inside ? first_half[PACKED_AT(c)] + second_half[PACKED_AT(c)] : 0.0f;
        of_guides += inside ? first_guide[PACKED_AT(c)] + second_guide[PACKED_AT(c)] : 0.0f;
    }
    const bool no_image = !is_finite(of_images), no_guide = !is_finite(of_guides);
    const real part = no_guide ? R(0) : no_image ? R(1) : r_min(follow, R(1));
    if (!inside)
        return;
#pragma unroll
    for (uint c = 0; c < 3; ++c) {
        const real a = first_half[PACKED_AT(c)], b = second_half[PACKED_AT(c)];
        const real guide_a = first_guide[PACKED_AT(c)], guide_b = second_guide[PACKED_AT(c)];
        const real image = no_image ? R(0) : share * a + rest * b;
        const real guide = no_guide ? R(0) : share * guide_a + rest * guide_b;
        result[PACKED_AT(c)] = (float)(image + part * (guide - image));
    }
}
