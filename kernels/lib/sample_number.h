/* The number that a sample's random numbers go by, from its place among the samples of a pixel: low and high words.
 *
 * TRAIT_HALVES: the samples are two halves, even ones and odd ones, and nothing may be common to both. What the pixels
 * of a sample share (their place within the pixel, their point of the lens) follows a sequence whose start goes by the
 * high word. So even samples are numbered one after the other, and odd ones likewise from 2^63 on, where no other
 * sample is. */
#ifndef GRADUS_LIB_SAMPLE_NUMBER_H
#define GRADUS_LIB_SAMPLE_NUMBER_H
//! traits: TRAIT_HALVES

#if TRAIT_HALVES
#define SAMPLE_LOW(low, high) ((low) >> 1 | (high) << 31)
#define SAMPLE_HIGH(low, high) ((high) >> 1 | (low) << 31)
#else
#define SAMPLE_LOW(low, high) (low)
#define SAMPLE_HIGH(low, high) (high)
#endif

#endif
