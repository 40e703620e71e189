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
 * that from the mean of all.
 *
 * Where samples count for the pixels around (kernels/lib/filter_frame.h), it adds what those of one frame add up to.
 *
 * TRAIT_PART_BITS: frames are those of one part of the samples, from `first_slot` on each 2^TRAIT_PART_BITS-th one. */
//! traits: TRAIT_PART_BITS
#include "kernels/lib/compensated.h"
#include "kernels/lib/filter_frame.h"
#include "kernels/lib/gradient.h"
#include "kernels/lib/squared_deviation.h"

#define NEXT_FRAME (strip_pixels << TRAIT_PART_BITS)
#define LOAD(number, to)                                                                                               \
    compensated s;                                                                                                     \
    s.sum = FILM(gradient_film_primal_r + number, to);                                                                 \
    s.correction = FILM(gradient_film_correction_first + number, to);                                                  \
    real spread = FILM(gradient_film_deviation_first + number, to);
#define STORE(number, to)                                                                                              \
    FILM(gradient_film_primal_r + number, to) = s.sum;                                                                 \
    FILM(gradient_film_correction_first + number, to) = s.correction;                                                  \
    FILM(gradient_film_deviation_first + number, to) = spread;
#define FILM(column, to) gradient_film[(size_t)(column)*pixels + (to)]

#if HAS_FRAME
#define ADD(number, to, column)                                                                                        \
    {                                                                                                                  \
        LOAD(number, to)                                                                                               \
        const real value = FILTERED(gradient_frame, gradient_frame_##column, pixel);                                   \
        spread += squared_deviation((real)frames_before, value, s.sum);                                                \
        s = compensated_add(s, value);                                                                                 \
        STORE(number, to)                                                                                              \
    }

STAGE gradient_accumulate(uint count, uint pixels, uint first_pixel, uint frames_before,
                          __global const real *gradient_frame, __global real *gradient_film, FILTER_ARGUMENTS) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t pixel = (size_t)first_pixel + i, above = pixel - crop_width;
    FILTER_TAPS
    ADD(0, pixel, primal_r)
    ADD(1, pixel, primal_g)
    ADD(2, pixel, primal_b)
    ADD(3, pixel, right_r)
    ADD(4, pixel, right_g)
    ADD(5, pixel, right_b)
    ADD(6, above, above_r)
    ADD(7, above, above_g)
    ADD(8, above, above_b)
}

#else
/* `sample` is that of slot `at`, for pixel `to` of the film. */
#define ADD(number, to, sample)                                                                                        \
    {                                                                                                                  \
        LOAD(number, to)                                                                                               \
        _Pragma("unroll") for (uint frame = 0; frame < accumulated_frames; ++frame) {                                  \
            const int is_there = frame < frames;                                                                       \
            const size_t at = slot + (is_there ? frame * NEXT_FRAME : 0u);                                             \
            const real value = sample;                                                                                 \
            spread += is_there ? squared_deviation((real)(frames_before + frame), value, s.sum) : R(0);                \
            const compensated added = compensated_add(s, value);                                                       \
            s.sum = is_there ? added.sum : s.sum;                                                                      \
            s.correction = is_there ? added.correction : s.correction;                                                 \
        }                                                                                                              \
        STORE(number, to)                                                                                              \
    }
#define DIFFERENCE(j, channel, of) AT(difference, value_##channel, (size_t)(j)*slots + (of))
/* Of the pixel above slot `at`, to below. */
#define FROM_ABOVE(channel) (is_carried ? AT(carry, value_##channel, i) : DIFFERENCE(2, channel, at - crop_width))

STAGE gradient_accumulate(uint count, uint slots, uint pixels, uint first_slot, uint first_pixel, uint first_above,
                          uint is_carried, uint has_above, uint frames, uint frames_before, __global const real *prefix,
                          __global const real *difference, __global real *gradient_film, __global const real *carry,
                          STRIP_PLACE) {
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
#endif
