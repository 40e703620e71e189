/* The number that a sample's random numbers go by, from its place among the samples of a pixel: low and high words.
 *
 * TRAIT_HALVES: the samples are two halves, even ones and odd ones, and nothing may be common to both. What the pixels
 * of a sample share (their place within the pixel, their point of the lens) follows a sequence whose start goes by the
 * high word. So even samples are numbered one after the other, and odd ones likewise from 2^63 on, where no other
 * sample is. */
#ifndef GRADUS_LIB_SAMPLE_NUMBER_H
#define GRADUS_LIB_SAMPLE_NUMBER_H
//! traits: TRAIT_HALVES

#include "kernels/shared/compat.h"

GRADUS_LIB_BEGIN

typedef struct {
    uint low, high;
    GRADUS_NOT_IN_REGISTERS
} sample_number;

/* Of the sample `more` samples of its pixel after the one at the place (first_low, first_high). */
GRADUS_FN sample_number sample_number_of(uint first_low, uint first_high, uint more) {
    const uint low = first_low + more, high = first_high + (low < first_low ? 1u : 0u);
    sample_number number;
#if TRAIT_HALVES
    number.low = low >> 1 | high << 31;
    number.high = high >> 1 | low << 31;
#else
    number.low = low;
    number.high = high;
#endif
    return number;
}

GRADUS_LIB_END

#endif
