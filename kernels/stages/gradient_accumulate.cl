/* gradient_accumulate: adds the primal samples and gradients of `frames` frames to the film, frame after frame: slots
 * `first_slot` on, at most accumulated_frames of them. The gradient between two pixels is what the one's offset path to
 * the other gives, less what the other's to the one gives (Kettunen et al. 2015). */
#include "kernels/lib/compensated.h"
#include "kernels/lib/gradient.h"

/* `sample` is that of slot `at`. */
#define ADD(number, sample)                                                                                            \
    {                                                                                                                  \
        compensated s;                                                                                                 \
        s.sum = FILM(gradient_film_primal_r + number);                                                                 \
        s.correction = FILM(gradient_film_correction_first + number);                                                  \
        real square = FILM(gradient_film_square_first + number);                                                       \
        _Pragma("unroll") for (uint frame = 0; frame < accumulated_frames; ++frame) {                                  \
            const int is_there = frame < frames;                                                                       \
            const uint at = slot + (is_there ? frame * pixels : 0u);                                                   \
            const real value = sample;                                                                                 \
            const compensated added = compensated_add(s, value);                                                       \
            s.sum = is_there ? added.sum : s.sum;                                                                      \
            s.correction = is_there ? added.correction : s.correction;                                                 \
            square += is_there ? value * value : R(0);                                                                 \
        }                                                                                                              \
        FILM(gradient_film_primal_r + number) = s.sum;                                                                 \
        FILM(gradient_film_correction_first + number) = s.correction;                                                  \
        FILM(gradient_film_square_first + number) = square;                                                            \
    }
#define FILM(column) gradient_film[(size_t)(column)*pixels + pixel]
#define DIFFERENCE(j, channel, of) AT(difference, value_##channel, (size_t)(j)*slots + (of))

STAGE gradient_accumulate(uint count, uint slots, uint first_slot, uint frames, __global const real *prefix,
                          __global const real *difference, __global real *gradient_film, FILM_PLACE) {
    const size_t pixel = work_item();
    if (pixel >= count)
        return;
    const uint slot = first_slot + (uint)pixel;
    const film_pixel place = PIXEL_OF(slot);
    const uint to_right = gradient_neighbour(slot, 0u, place, crop_width, crop_height) - slot;
    const uint to_below = gradient_neighbour(slot, 2u, place, crop_width, crop_height) - slot;
    const int has_right = to_right != 0u, has_below = to_below != 0u;
    ADD(0, AT(prefix, value_r, at))
    ADD(1, AT(prefix, value_g, at))
    ADD(2, AT(prefix, value_b, at))
    ADD(3, has_right ? DIFFERENCE(0, r, at) - DIFFERENCE(1, r, at + to_right) : R(0))
    ADD(4, has_right ? DIFFERENCE(0, g, at) - DIFFERENCE(1, g, at + to_right) : R(0))
    ADD(5, has_right ? DIFFERENCE(0, b, at) - DIFFERENCE(1, b, at + to_right) : R(0))
    ADD(6, has_below ? DIFFERENCE(2, r, at) - DIFFERENCE(3, r, at + to_below) : R(0))
    ADD(7, has_below ? DIFFERENCE(2, g, at) - DIFFERENCE(3, g, at + to_below) : R(0))
    ADD(8, has_below ? DIFFERENCE(2, b, at) - DIFFERENCE(3, b, at + to_below) : R(0))
}
