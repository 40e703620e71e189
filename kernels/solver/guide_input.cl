/* From the caller's planes to those of the feature filter (solver/guide/feature_filter.h). */
#include "kernels/lib/approximation.h"
#include "kernels/lib/finite.h"
#include "kernels/shared/guide_shared.h"
#include "kernels/solver/grid.h"

/* A value has a variance of at least this share of the squared brightness around it, and its trust a larger one: two
 * halves that agree by chance are not sure. */
#define LEAST_VARIANCE_SHARE R(1e-6)
#define LEAST_DOUBT_SHARE R(1e-4)
#define LEAST_VARIANCE R(1e-30)

/* Both halves and their mean, 0 where any value is missing; and what is to be smoothed, `share` being the first half's
 * part of the samples: the mean of halves of n and m samples has n m / (n + m)^2 times their squared difference as its
 * variance. */
SOLVE guide_import(GRID, real share, __global const float *first_half, __global const float *second_half,
                   __global real *images, __global real *statistics) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const bool inside = x < width;
    uint missing = 0;
#pragma unroll
    for (uint c = 0; c < 3; ++c)
        missing |= (is_finite(inside ? first_half[PACKED_AT(c)] : 0.0f) ? 0 : 1) |
                   (is_finite(inside ? second_half[PACKED_AT(c)] : 0.0f) ? 0 : 1);
    const bool counts = inside && missing == 0;
    const real rest = R(1) - share;
    real brightness = R(0);
#pragma unroll
    for (uint c = 0; c < 3; ++c) {
        const real a = inside ? first_half[PACKED_AT(c)] : 0.0f, b = inside ? second_half[PACKED_AT(c)] : 0.0f;
        const real one = counts ? a : R(0), two = counts ? b : R(0), mean = share * one + rest * two;
        images[GRID_AT(GUIDE_FIRST + c, x, y)] = one;
        images[GRID_AT(GUIDE_SECOND + c, x, y)] = two;
        images[GRID_AT(GUIDE_MEAN + c, x, y)] = mean;
        statistics[GRID_AT(GUIDE_VARIANCE + c, x, y)] = share * rest * (one - two) * (one - two);
        brightness += mean * mean * R(1.0 / 3);
    }
    statistics[GRID_AT(GUIDE_BRIGHTNESS, x, y)] = brightness;
    statistics[GRID_AT(GUIDE_VALID, x, y)] = counts ? R(1) : R(0);
}

/* After smoothing: the variance of the mean at each pixel, by channel, and the trust in its value, the inverse root of
 * that of all channels: values would have the least error if weighted by the inverse itself, but where noise is rare
 * and bright that loses light. Both are 0 where the pixel does not count. */
SOLVE guide_prepare(GRID, __global const real *smoothed, __global const real *valid, __global real *certainty) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const real area = smoothed[GRID_AT(GUIDE_VALID, x, y)], scale = R(1) / r_max(area, R(1e-20));
    const bool counts = x < width && valid[GRID_AT(GUIDE_VALID, x, y)] > R(0);
    const real bright = smoothed[GRID_AT(GUIDE_BRIGHTNESS, x, y)] * scale;
    real sum = R(0);
#pragma unroll
    for (uint c = 0; c < 3; ++c) {
        const real variance = smoothed[GRID_AT(GUIDE_VARIANCE + c, x, y)] * scale;
        sum += variance;
        certainty[GRID_AT(GUIDE_VARIANCE + c, x, y)] =
            counts ? variance + (LEAST_VARIANCE_SHARE * bright + LEAST_VARIANCE) : R(0);
    }
    const real doubt = sum * R(1.0 / 3) + (LEAST_DOUBT_SHARE * bright + LEAST_VARIANCE);
    certainty[GRID_AT(GUIDE_TRUST, x, y)] = counts ? R(1) / r_sqrt(doubt) : R(0);
}

/* Features, each in units of the difference that sets two pixels apart; of the depth, times `depth_scale`, its
 * logarithm. What is missing is as far as nothing. */
SOLVE guide_import_features(GRID, real albedo_unit, real normal_unit, real depth_unit, real depth_scale,
                            __global const float *packed, __global real *features) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const bool inside = x < width;
#pragma unroll
    for (uint c = 0; c < GUIDE_FEATURES; ++c) {
        const real given = inside ? packed[PACKED_AT(c)] : 0.0f;
        const real value = is_finite(given) ? given : R(0);
        const real unit = c < 3 ? albedo_unit : c < 6 ? normal_unit : depth_unit;
        features[GRID_AT(c, x, y)] =
            (c < 6 ? value : approx_log(r_clamp(value * depth_scale, R(1e-6), R(1e30)))) * unit;
    }
}
