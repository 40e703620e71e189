/* The number that a sample's random numbers go by, from its place among the samples of a pixel: low and high words.
 *
 * TRAIT_HALVES: the samples are two halves, even ones and odd ones, and no path of one has a random number of the
 * other: even samples are numbered one after the other, and odd ones likewise from 2^63 on, where no other sample is.
 * What all pixels of a sample share (their place within the pixel, their point of the lens, their side of a blend) goes
 * by the place among all samples: one sequence fills the pixel more evenly than two. */
#ifndef GRADUS_LIB_SAMPLE_NUMBER_H
#define GRADUS_LIB_SAMPLE_NUMBER_H
//! traits: TRAIT_HALVES

#include "kernels/lib/sample_place.h"

GRADUS_LIB_BEGIN

GRADUS_FN sample_place sample_number_at(sample_place place) {
#if TRAIT_HALVES
    sample_place number;
    number.low = place.low >> 1 | place.high << 31;
    number.high = place.high >> 1 | place.low << 31;
    return number;
#else
    return place;
#endif
}

GRADUS_LIB_END

#endif
