/* What the samples of a frame add up to at a pixel, where the pixel filter reaches beyond it
 * (runtime/scene/filter_table.h). */
#ifndef GRADUS_LIB_FILTER_FRAME_H
#define GRADUS_LIB_FILTER_FRAME_H
//! traits: TRAIT_FILTER
#include "kernels/lib/filter_table.h"

/* Whether samples count for the pixels around. */
#define HAS_FRAME (TRAIT_FILTER > 1)

#if HAS_FRAME
#define FILTER_REACH (TRAIT_FILTER - 1)
#define filter_width (2 * FILTER_REACH + 1)

/* As kernel arguments. Where within their pixels the samples of the frame lie: filter_number() along both axes. */
#define FILTER_ARGUMENTS uint filter_x, uint filter_y, __global const real *filter_taps, uint crop_width
#if FILTER_REACH <= 3
#define UNROLL_TAPS _Pragma("unroll")
#else
#define UNROLL_TAPS
#endif

/* Declares what samples weigh, for FILTERED. */
#define FILTER_TAPS                                                                                                    \
    const filter_place place_x = filter_place_at(filter_x), place_y = filter_place_at(filter_y);                       \
    real across[filter_width], down[filter_width];                                                                     \
    UNROLL_TAPS for (uint tap = 0; tap < filter_width; ++tap) {                                                        \
        across[tap] = filter_tap(filter_taps, FILTER_REACH, place_x, tap);                                             \
        down[tap] = filter_tap(filter_taps, FILTER_REACH, place_y, tap);                                               \
    }
/* Of a column of a frame, at a pixel around which the filter leaves no row. */
#define FILTERED(table, column, pixel)                                                                                 \
    filtered((table) + (size_t)(column)*ROWS_OF_##table, pixel, crop_width, across, down)

GRADUS_LIB_BEGIN

GRADUS_FN real filtered(__global const real *column, size_t pixel, uint width, const real *across, const real *down) {
    real sum = R(0);
    UNROLL_TAPS for (uint y = 0; y < filter_width; ++y) {
        /* The sample of tap t is that of the pixel t - FILTER_REACH before. */
        __global const real *row = column + ((size_t)FILTER_REACH * (width + 1u)) - (size_t)y * width;
        real of_row = R(0);
        UNROLL_TAPS for (uint x = 0; x < filter_width; ++x) of_row += across[x] * row[pixel - x];
        sum += down[y] * of_row;
    }
    return sum;
}

GRADUS_LIB_END
#endif
#endif
