/* gradient_accumulate: adds one frame's primal samples and gradients to the film: slots `first_slot` on. The gradient
 * between two pixels is what the one's offset path to the other gives, less what the other's to the one gives (Kettunen
 * et al. 2015). */
#include "kernels/lib/compensated.h"
#include "kernels/lib/gradient.h"

#define ADD(number, x)                                                                                                 \
    {                                                                                                                  \
        const real value = x;                                                                                          \
        compensated s;                                                                                                 \
        s.sum = FILM(gradient_film_primal_r + number);                                                                 \
        s.correction = FILM(gradient_film_correction_first + number);                                                  \
        s = compensated_add(s, value);                                                                                 \
        FILM(gradient_film_primal_r + number) = s.sum;                                                                 \
        FILM(gradient_film_correction_first + number) = s.correction;                                                  \
        FILM(gradient_film_square_first + number) += value * value;                                                    \
    }
#define FILM(column) gradient_film[(size_t)(column)*pixels + pixel]
#define DIFFERENCE(j, channel, at) AT(difference, value_##channel, (size_t)(j)*slots + (at))

STAGE gradient_accumulate(uint count, uint slots, uint first_slot, __global const real *prefix,
                          __global const real *difference, __global real *gradient_film, FILM_PLACE) {
    const size_t pixel = get_global_id(0);
    if (pixel >= count)
        return;
    const uint slot = first_slot + (uint)pixel;
    const film_pixel place = PIXEL_OF(slot);
    const uint right = gradient_neighbour(slot, 0u, place, crop_width, crop_height);
    const uint below = gradient_neighbour(slot, 2u, place, crop_width, crop_height);
    const int has_right = right != slot, has_below = below != slot;
    ADD(0, AT(prefix, value_r, slot))
    ADD(1, AT(prefix, value_g, slot))
    ADD(2, AT(prefix, value_b, slot))
    ADD(3, has_right ? DIFFERENCE(0, r, slot) - DIFFERENCE(1, r, right) : R(0))
    ADD(4, has_right ? DIFFERENCE(0, g, slot) - DIFFERENCE(1, g, right) : R(0))
    ADD(5, has_right ? DIFFERENCE(0, b, slot) - DIFFERENCE(1, b, right) : R(0))
    ADD(6, has_below ? DIFFERENCE(2, r, slot) - DIFFERENCE(3, r, below) : R(0))
    ADD(7, has_below ? DIFFERENCE(2, g, slot) - DIFFERENCE(3, g, below) : R(0))
    ADD(8, has_below ? DIFFERENCE(2, b, slot) - DIFFERENCE(3, b, below) : R(0))
}
