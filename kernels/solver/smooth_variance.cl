/* Variances as weights need them (solver/weighted_reconstruction.h).
 *
 * A variance that was measured with a few samples is itself noise, and most often too small: what is rare was not met.
 * Smoothed over a few pixels it knows too little, over many it takes what is sure beside an edge for as unsure as the
 * edge. So it is smoothed by several widths, each from the one before (a trous: Holschneider et al. 1989), and the
 * geometric mean of all is taken. */
#include "kernels/lib/approximation.h"
#include "kernels/lib/finite.h"
#include "kernels/solver/grid.h"

#define IMAGE uint width, uint height
#define PIXELS ((size_t)width * height)
#define PLANE_AT(plane) (((size_t)(plane)*height + y) * width + x)
#define IMAGE_PLACE                                                                                                    \
    const size_t x = get_global_id(0), y = get_global_id(1);                                                           \
    if (x >= width)                                                                                                    \
        return;

/* The least variance: its logarithm is a number, and so is what it is divided by. */
#define LEAST_VARIANCE R(1e-30)

/* The mean over the channels, -1 where it is missing: NaN, infinite, or (of variances) below zero. */
SOLVE mean_of_channels(IMAGE, uint is_variance, __global const float *packed, __global real *mean) {
    IMAGE_PLACE
    real sum = R(0);
    for (uint c = 0; c < SOLVER_CHANNELS; ++c)
        sum += packed[PLANE_AT(c)];
    const int is_there = is_finite(sum) && (sum >= R(0) || !is_variance);
    mean[PLANE_AT(0)] = is_there ? r_abs(sum) * R(1.0 / SOLVER_CHANNELS) : R(-1);
}

/* smoothed = the mean of `image` and of its neighbours `apart` pixels away, which count `side` beside it, at the
 * corners side^2; -1 where none of them is there. Only `columns` and `rows` of the image are. */
SOLVE smooth_image(IMAGE, uint columns, uint rows, uint apart, real side, __global const real *image,
                   __global real *smoothed) {
    IMAGE_PLACE
    real sum = R(0), weight = R(0);
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const int at_x = (int)x + dx * (int)apart, at_y = (int)y + dy * (int)apart;
            const int inside = at_x >= 0 && at_y >= 0 && at_x < (int)columns && at_y < (int)rows;
            const real value = image[inside ? (size_t)at_y * width + (size_t)at_x : PLANE_AT(0)];
            const real tap = (dx == 0 ? R(1) : side) * (dy == 0 ? R(1) : side);
            const real one = inside && value >= R(0) ? tap : R(0);
            sum += one * value;
            weight += one;
        }
    smoothed[PLANE_AT(0)] = weight > R(0) ? sum / weight : R(-1);
}

/* logarithms += share log(variance), and in the second plane += share. A variance is at least `least` times the squared
 * brightness. */
SOLVE add_logarithm(IMAGE, real share, real least, uint begins, __global const real *variance,
                    __global const real *brightness, __global real *logarithms) {
    IMAGE_PLACE
    const size_t at = PLANE_AT(0), at_share = PLANE_AT(1);
    const real v = variance[at], b = r_max(brightness[at], R(0));
    const real one = v >= R(0) ? share : R(0);
    const real logarithm = one * approx_log(r_max(v, R(0)) + least * b * b + LEAST_VARIANCE);
    logarithms[at] = (begins ? R(0) : logarithms[at]) + logarithm;
    logarithms[at_share] = (begins ? R(0) : logarithms[at_share]) + one;
}

/* The geometric mean, the same for all channels; -1 where nothing was there. */
SOLVE geometric_mean(IMAGE, __global const real *logarithms, __global float *smoothed) {
    IMAGE_PLACE
    const real share = logarithms[PLANE_AT(1)];
    const real mean = approx_exp(logarithms[PLANE_AT(0)] / (share > R(0) ? share : R(1)));
    const float value = share > R(0) ? (float)mean : -1.0f;
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
