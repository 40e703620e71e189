/* Gives a guided image back the light that its guide has lost, by place (solver/guide/light_correction.h). */
#include "kernels/lib/approximation.h"
#include "kernels/lib/finite.h"
#include "kernels/lib/ordered.h"
#include "kernels/shared/guide_shared.h"
#include "kernels/solver/grid.h"

/* How much brighter or darker, in logarithms, a neighbour is that counts e^-1/2 as much, and at most what share of its
 * brightness a pixel is given. */
#define LIGHT_APART R(0.3)
#define LARGEST_SHARE R(0.3)

/* By pixel: what the halves have more than the image, and the image's brightness, at least `least`; that and its
 * logarithm, with `dim` added, so that what is dark is alike. Nothing is lost where a value is not finite. */
SOLVE guide_lost(GRID, real share, real least, real dim, __global const float *first_half,
                 __global const float *second_half, __global const float *image, __global real *lost,
                 __global real *brightness) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const bool inside = x < width;
    real sum = R(0), missing = R(0);
    real more[3];
#pragma unroll
    for (uint c = 0; c < 3; ++c) {
        const real a = inside ? first_half[PACKED_AT(c)] : 0.0f, b = inside ? second_half[PACKED_AT(c)] : 0.0f;
        const real value = inside ? image[PACKED_AT(c)] : 0.0f;
        more[c] = share * a + (R(1) - share) * b - value;
        missing += more[c];
        sum += value;
    }
    const bool counts = inside && is_finite(missing);
    const real bright = r_max(counts ? r_abs(sum) * R(1.0 / 3) : R(0), least);
#pragma unroll
    for (uint c = 0; c < 3; ++c)
        lost[GRID_AT(c, x, y)] = counts ? more[c] : R(0);
    lost[GRID_AT(GUIDE_BRIGHT, x, y)] = counts ? bright : R(0);
    brightness[GRID_AT(0, x, y)] = inside ? bright : R(0);
    brightness[GRID_AT(1, x, y)] = inside ? approx_log(bright + dim) : R(0);
}

/* The line that lies `down` from row `line` of the padded plane, or one of zeros. */
#define LINE_AT(down)                                                                                                  \
    ((int)y + 1 + (down) < 0 ? 0 : (int)y + 1 + (down) > (int)height + 1 ? (int)height + 1 : (int)y + 1 + (down))

/* Sums over five pixels that lie (across, down) from each other, with the weights of a cubic spline, less where they
 * are of another brightness. */
SOLVE guide_light_pass(GRID, uint across, uint down, uint unit, __global const real *brightness,
                       __global const real *lost, __global real *smoothed) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const real here = brightness[GRID_AT(1, x, y)];
    real sum[GUIDE_LOST] = {R(0), R(0), R(0), R(0)};
#pragma unroll
    for (int k = -2; k <= 2; ++k) {
        const size_t at = (size_t)LINE_AT(k * (int)down) * row + SOLVER_MARGIN + x + (size_t)(k * (int)across);
        const real apart = (brightness[(size_t)plane + at] - here) * (R(1) / LIGHT_APART);
        const real tap = k == 0 ? R(0.375) : k * k == 1 ? R(0.25) : R(0.0625);
        real weight = tap * approx_exp(R(-0.5) * apart * apart);
#pragma unroll
        for (uint c = 0; c < GUIDE_LOST; ++c) {
            sum[c] += weight * lost[(size_t)c * unit * plane + at];
            weight = r_after(weight, sum[c]);
        }
    }
#pragma unroll
    for (uint c = 0; c < GUIDE_LOST; ++c)
        smoothed[GRID_AT(c, x, y)] = x < width ? sum[c] : R(0);
}

/* image += brightness times the share of it that was lost around; not below zero where it was not. */
SOLVE guide_give_back(GRID, __global const real *brightness, __global const real *smoothed, __global float *image) {
    SOLVER_PLACE_OF_ALL_CHANNELS
    const real around = smoothed[GRID_AT(GUIDE_BRIGHT, x, y)], bright = brightness[GRID_AT(0, x, y)];
    const real scale = around > R(0) ? R(1) / around : R(0);
    real given[3];
#pragma unroll
    for (uint c = 0; c < 3; ++c)
        given[c] = bright * r_clamp(smoothed[GRID_AT(c, x, y)] * scale, -LARGEST_SHARE, LARGEST_SHARE);
    if (x >= width)
        return;
#pragma unroll
    for (uint c = 0; c < 3; ++c) {
        const real value = image[PACKED_AT(c)];
        image[PACKED_AT(c)] = (float)r_max(value + given[c], r_min(value, R(0)));
    }
}
