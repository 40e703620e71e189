/* The number that a sample's random numbers go by, from its place among the samples of a pixel: low and high words.
 *
 * TRAIT_PART_BITS, b: the samples are 2^b parts, by their places modulo 2^b, and no path of one has a random number of
 * another: samples of a part are numbered one after the other, those of part p from p 2^(64 - b) on, where no other
 * sample is. With other high words they are scrambled apart, too (kernels/lib/stratified.h).
 *
 * What all pixels of a sample share (their place within the pixel, their point of the lens, their side of a blend) goes
 * by the place among all samples where parts are halves: one sequence fills the pixel more evenly than two. Replicates,
 * which are more than two, have it apart as well: their spread is to tell the variance of all that is drawn. */
#ifndef GRADUS_LIB_SAMPLE_NUMBER_H
#define GRADUS_LIB_SAMPLE_NUMBER_H
//! traits: TRAIT_PART_BITS

#include "kernels/lib/sample_place.h"

GRADUS_LIB_BEGIN

GRADUS_FN sample_place sample_number_at(sample_place place) {
#if TRAIT_PART_BITS
    sample_place number;
    number.low = place.low >> TRAIT_PART_BITS | place.high << (32 - TRAIT_PART_BITS);
    number.high = place.high >> TRAIT_PART_BITS | place.low << (32 - TRAIT_PART_BITS);
    return number;
#else
    return place;
#endif
}

/* That of what all pixels of the sample share. */
GRADUS_FN sample_place shared_number_at(sample_place place) {
#if TRAIT_PART_BITS > 1
    return sample_number_at(place);
#else
    return place;
#endif
}

GRADUS_LIB_END

#endif
