/* Where a sample stands among the samples of its pixel: low and high words. */
#ifndef GRADUS_LIB_SAMPLE_PLACE_H
#define GRADUS_LIB_SAMPLE_PLACE_H

#include "kernels/shared/compat.h"

GRADUS_LIB_BEGIN

typedef struct {
    uint low, high;
    GRADUS_NOT_IN_REGISTERS
} sample_place;

/* `more` samples after the place (first_low, first_high). */
GRADUS_FN sample_place sample_place_after(uint first_low, uint first_high, uint more) {
    sample_place place;
    place.low = first_low + more;
    place.high = first_high + (place.low < first_low ? 1u : 0u);
    return place;
}

GRADUS_LIB_END

#endif
