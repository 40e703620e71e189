/* gradient_accumulate: adds the primal samples and gradients of a strip to the film: slots `first_slot` on, whose
 * pixels are those from `first_pixel` on, of `frames` frames, at most accumulated_frames of them, one after the other.
 * The gradient between two pixels is what the one's offset path to the other gives, less what the other's to the one
 * gives (Kettunen et al. 2015).
 *
 * The gradient to the pixel below belongs to the row above: so the first row of a strip finishes that of the strip
 * before, whose part is in `carry`. It has a launch of its own (`is_carried`). The pixels above are those from
 * `first_above` on; the first row of all has none, and adds nothing to the last row (`has_above` 0), where nobody else
 * adds.
 *
 * The film has had `frames_before` frames. Each sample adds its squared deviation from their mean, so that the sum is
 * that from the mean of all (Welford 1962): of a sum of squares the square of the mean would be taken off, which leaves
 * rounding where the spread is small beside it.
 *
 * Where frames weigh other than 1 (a filter with negative lobes), samples are times the weight of theirs, and means are
 * sums over the sum of the weights before (weights_0 of the first frame), whose squares sum up to squares_0.
 *
 * TRAIT_PART_BITS: frames are those of one part of the samples, from `first_slot` on each 2^TRAIT_PART_BITS-th one. */
//! traits: TRAIT_PART_BITS TRAIT_FILTER_SIGNED
#include "kernels/lib/compensated.h"
#include "kernels/lib/filter_weight.h"
#include "kernels/lib/gradient.h"

#define NEXT_FRAME (strip_pixels << TRAIT_PART_BITS)
#if TRAIT_FILTER_SIGNED
/* Of each frame by itself: a sum that went on from frame to frame would depend on where a launch begins. */
#define BEFORE                                                                                                         \
    const real weights[accumulated_frames] = {weights_0, weights_1, weights_2, weights_3};                             \
    const real squares[accumulated_frames] = {squares_0, squares_1, squares_2, squares_3};
#define SQUARED_DEVIATION(at, frame, value, sum)                                                                       \
    weighted_deviation(AT(filtered, weight, at), weights[frame], squares[frame], value, sum)
#else
#define BEFORE
#define SQUARED_DEVIATION(at, frame, value, sum) squared_deviation((real)(frames_before + frame), value, sum)
GRADUS_FN real squared_deviation(real before, real value, real sum) {
    const real deviation = value - sum * (R(1) / r_max(before, R(1)));
    return deviation * (deviation * (before / (before + R(1))));
}
#endif
/* `sample` is that of slot `at`, for pixel `to` of the film. */
#define ADD(number, to, sample)                                                                                        \
    {                                                                                                                  \
        compensated s;                                                                                                 \
        s.sum = FILM(gradient_film_primal_r + number, to);                                                             \
        s.correction = FILM(gradient_film_correction_first + number, to);                                              \
        real spread = FILM(gradient_film_deviation_first + number, to);                                                \
        BEFORE                                                                                                         \
        _Pragma("unroll") for (uint frame = 0; frame < accumulated_frames; ++frame) {                                  \
            const int is_there = frame < frames;                                                                       \
            const size_t at = slot + (is_there ? frame * NEXT_FRAME : 0u);                                             \
            const real value = sample;                                                                                 \
            spread += is_there ? SQUARED_DEVIATION(at, frame, value, s.sum) : R(0);                                    \
            const compensated added = compensated_add(s, value);                                                       \
            s.sum = is_there ? added.sum : s.sum;                                                                      \
            s.correction = is_there ? added.correction : s.correction;                                                 \
        }                                                                                                              \
        FILM(gradient_film_primal_r + number, to) = s.sum;                                                             \
        FILM(gradient_film_correction_first + number, to) = s.correction;                                              \
        FILM(gradient_film_deviation_first + number, to) = spread;                                                     \
    }
#define FILM(column, to) gradient_film[(size_t)(column)*pixels + (to)]
#define DIFFERENCE(j, channel, of) AT(difference, value_##channel, (size_t)(j)*slots + (of))
/* Of the pixel above slot `at`, to below. */
#define FROM_ABOVE(channel) (is_carried ? AT(carry, value_##channel, i) : DIFFERENCE(2, channel, at - crop_width))

STAGE gradient_accumulate(uint count, uint slots, uint pixels, uint first_slot, uint first_pixel, uint first_above,
                          uint is_carried, uint has_above, uint frames, uint frames_before, __global const real *prefix,
                          __global const real *difference, __global real *gradient_film, __global const real *carry,
                          STRIP_PLACE
#if TRAIT_FILTER_SIGNED
                          ,
                          real weights_0, real weights_1, real weights_2, real weights_3, real squares_0,
                          real squares_1, real squares_2, real squares_3, __global const real *filtered
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t slot = (size_t)first_slot + i, pixel = (size_t)first_pixel + i, above = (size_t)first_above + i;
    const uint row = divide((uint)i, width_multiplier, width_shift);
    const int has_right = (uint)i - row * crop_width + 1u < crop_width;
    ADD(0, pixel, AT(prefix, value_r, at))
    ADD(1, pixel, AT(prefix, value_g, at))
    ADD(2, pixel, AT(prefix, value_b, at))
    ADD(3, pixel, has_right ? DIFFERENCE(0, r, at) - DIFFERENCE(1, r, at + 1u) : R(0))
    ADD(4, pixel, has_right ? DIFFERENCE(0, g, at) - DIFFERENCE(1, g, at + 1u) : R(0))
    ADD(5, pixel, has_right ? DIFFERENCE(0, b, at) - DIFFERENCE(1, b, at + 1u) : R(0))
    ADD(6, above, has_above ? FROM_ABOVE(r) - DIFFERENCE(3, r, at) : R(0))
    ADD(7, above, has_above ? FROM_ABOVE(g) - DIFFERENCE(3, g, at) : R(0))
    ADD(8, above, has_above ? FROM_ABOVE(b) - DIFFERENCE(3, b, at) : R(0))
}
