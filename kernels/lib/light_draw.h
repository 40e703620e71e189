/* A column of an alias table of lights by two random numbers, and the number that decides between the column's light
 * and its alias.
 *
 * MANY_LIGHTS: both numbers make one of 48 bits. A column by 24 bits alone would be off by 6 % among a million lights,
 * and some of more than 16 million would never be drawn. */
#ifndef GRADUS_LIB_LIGHT_DRAW_H
#define GRADUS_LIB_LIGHT_DRAW_H
//! traits: MANY_LIGHTS
#include "kernels/lib/ordered.h"

GRADUS_LIB_BEGIN

typedef struct {
    uint column;
    real keeps; /* in [0, 1): below the column's threshold its own light is taken */
    GRADUS_NOT_IN_REGISTERS
} light_drawn;

/* a, b: multiples of 2^-24 in [0, 1). */
GRADUS_FN light_drawn light_draw(real a, real b, uint count) {
    light_drawn d;
#if MANY_LIGHTS
    /* The 48 bits times the count, in two parts: the whole part is the column, what is left is uniform again. */
    const uint high = (uint)(a * R(16777216)), low = (uint)(r_after(b, a) * R(16777216));
    const uint word = (high << 8) | (low >> 16);
    const uint rest = word * count, sum = rest + mul_hi(low << 16, count);
    d.column = mul_hi(word, count) + (sum < rest ? 1u : 0u);
    d.keeps = (real)(sum >> 8) * R(1.0 / 16777216.0);
#else
    d.column = min((uint)(a * (real)count), count - 1u);
    d.keeps = b;
#endif
    return d;
}

GRADUS_LIB_END
#endif
