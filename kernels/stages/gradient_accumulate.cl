/* gradient_accumulate: adds the primal samples and gradients of a strip to the film: slots `first_slot` on, those of
 * `frames` frames, at most accumulated_frames of them, one after the other. The gradient between two pixels is what the
 * one's offset path to the other gives, less what the other's to the one gives (Kettunen et al. 2015).
 *
 * The gradient to the pixel below belongs to the row above: so the first row of a strip finishes that of the strip
 * before, whose part is in `carry`.
 *
 * TRAIT_HALVES: frames are those of one half of the samples, every other one from `first_slot` on. */
//! traits: TRAIT_HALVES
#include "kernels/lib/compensated.h"
#include "kernels/lib/gradient.h"

#if TRAIT_HALVES
#define NEXT_FRAME (2u * strip_pixels)
#else
#define NEXT_FRAME strip_pixels
#endif
/* `sample` is that of slot `at`, for pixel `to` of the film. */
#define ADD(number, to, sample)                                                                                        \
    {                                                                                                                  \
        compensated s;                                                                                                 \
        s.sum = FILM(gradient_film_primal_r + number, to);                                                             \
        s.correction = FILM(gradient_film_correction_first + number, to);                                              \
        real square = FILM(gradient_film_square_first + number, to);                                                   \
        _Pragma("unroll") for (uint frame = 0; frame < accumulated_frames; ++frame) {                                  \
            const int is_there = frame < frames;                                                                       \
            const uint at = slot + (is_there ? frame * NEXT_FRAME : 0u);                                               \
            const real value = sample;                                                                                 \
            const compensated added = compensated_add(s, value);                                                       \
            s.sum = is_there ? added.sum : s.sum;                                                                      \
            s.correction = is_there ? added.correction : s.correction;                                                 \
            square += is_there ? value * value : R(0);                                                                 \
        }                                                                                                              \
        FILM(gradient_film_primal_r + number, to) = s.sum;                                                             \
        FILM(gradient_film_correction_first + number, to) = s.correction;                                              \
        FILM(gradient_film_square_first + number, to) = square;                                                        \
    }
#define FILM(column, to) gradient_film[(size_t)(column)*pixels + (to)]
#define DIFFERENCE(j, channel, of) AT(difference, value_##channel, (size_t)(j)*slots + (of))
/* Of the pixel above slot `at`, to below. */
#define FROM_ABOVE(channel)                                                                                            \
    (is_carried ? AT(carry, value_##channel, place.x) : DIFFERENCE(2, channel, above + (at - slot)))

STAGE gradient_accumulate(uint count, uint slots, uint pixels, uint first_slot, uint frames,
                          __global const real *prefix, __global const real *difference, __global real *gradient_film,
                          __global const real *carry, STRIP_PLACE) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const uint slot = first_slot + (uint)i;
    const film_pixel place = PIXEL_OF(slot);
    const uint pixel = place.y * crop_width + place.x;
    const int has_right = place.x + 1u < crop_width, has_above = place.y > 0u;
    const int is_carried = place.y == strip_first;
    const uint above = is_carried ? slot : slot - crop_width;
    const uint right = has_right ? 1u : 0u;
    ADD(0, pixel, AT(prefix, value_r, at))
    ADD(1, pixel, AT(prefix, value_g, at))
    ADD(2, pixel, AT(prefix, value_b, at))
    ADD(3, pixel, has_right ? DIFFERENCE(0, r, at) - DIFFERENCE(1, r, at + right) : R(0))
    ADD(4, pixel, has_right ? DIFFERENCE(0, g, at) - DIFFERENCE(1, g, at + right) : R(0))
    ADD(5, pixel, has_right ? DIFFERENCE(0, b, at) - DIFFERENCE(1, b, at + right) : R(0))
    /* The first row adds nothing to where nobody else adds: the last row has no gradient. */
    const uint pixel_above = has_above ? pixel - crop_width : pixels - crop_width + place.x;
    ADD(6, pixel_above, has_above ? FROM_ABOVE(r) - DIFFERENCE(3, r, at) : R(0))
    ADD(7, pixel_above, has_above ? FROM_ABOVE(g) - DIFFERENCE(3, g, at) : R(0))
    ADD(8, pixel_above, has_above ? FROM_ABOVE(b) - DIFFERENCE(3, b, at) : R(0))
}
