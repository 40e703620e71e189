/* Light from an image of all directions: its radiance, and sampling of directions by its luminance.
 *
 * The image is bilinear in the two angles, as Mitsuba's is: texel i of a row lies at (i + 1/2) / columns of a turn
 * about the map's y axis, which begins at -z and goes by +x; row j lies at the angle pi j / rows from +y, so the first
 * and the last row are the poles. Between four texels lies a cell; `rows` counts those.
 *
 * Sampling chooses a cell and then a place in it with exactly the density that environment_lookup() states. A texel has
 * beside its colour an importance, its luminance times the share of its row in the sphere; in a cell the density by
 * place is the bilinear function of the importances at its corners, normalised over all cells. By solid angle that is
 * the importance over the sine of the angle from the pole, times one number: `scale` below. So all that is interpolated
 * is loaded for the colour in any case, and a bright texel among dark ones is found with its own shape.
 *
 * Cells lie in strips of environment_strip along a row, padded with cells of importance 0. Alias tables (Vose 1991)
 * choose the strip and the cell in it. runtime/scene/environment_map.h makes all of this. */
#ifndef GRADUS_LIB_ENVIRONMENT_H
#define GRADUS_LIB_ENVIRONMENT_H
//! traits: TRAIT_LIGHT_ENVIRONMENT
#include "kernels/lib/ordered.h"
#include "kernels/lib/random.h"
#include "kernels/lib/vector.h"
#include "kernels/lib/warp.h"

#define environment_strip 256u

/* What functions and kernels take that look into the map: texels (two words each: r and g, b and importance, in
 * environment_number() each), cells (24 bits of threshold, 8 of alias) and strips (threshold of 32 bits, alias). */
#if TRAIT_LIGHT_ENVIRONMENT
#define ENVIRONMENT_PARAMETERS                                                                                         \
    , GRADUS_GLOBAL const uint *environment_texels, GRADUS_GLOBAL const uint *environment_cells,                       \
        GRADUS_GLOBAL const uint *environment_strips, uint environment_columns, uint environment_rows,                 \
        uint environment_strip_count
#define ENVIRONMENT_ARGUMENTS                                                                                          \
    , environment_texels, environment_cells, environment_strips, environment_columns, environment_rows,                \
        environment_strip_count
#else
#define ENVIRONMENT_PARAMETERS
#define ENVIRONMENT_ARGUMENTS
#endif

GRADUS_LIB_BEGIN

/* A number from 0 to 2^33 in 16 bits: 6 of exponent and 10 of mantissa. 2^-31 is taken off, so that 0 is 0 without a
 * choice; of what is larger than 2^-7 nothing is. After `before`, or several would be packed into a vector
 * (kernels/lib/ordered.h). */
GRADUS_FN real environment_number_after(uint code, real before) {
    return (real)as_float((code << 13) + 0x30000000u) - r_after(R(4.656612873077393e-10), before);
}
GRADUS_FN real environment_number(uint code) { return environment_number_after(code, R(0)); }

typedef struct {
    rgb radiance;    /* over the light's value */
    real importance; /* bilinear */
    GRADUS_NOT_IN_REGISTERS
} environment_texel;

GRADUS_FN environment_texel environment_load(GRADUS_GLOBAL const uint *environment_texels, uint texel, uint unit,
                                             real before) {
    const int place = (int)(texel * 2u);
    const uint first = environment_texels[place], second = (environment_texels + unit)[place];
    environment_texel t;
    t.importance = environment_number_after(second >> 16, before);
    t.radiance.r = environment_number_after(first & 0xFFFFu, t.importance);
    t.radiance.g = environment_number_after(first >> 16, t.radiance.r);
    t.radiance.b = environment_number_after(second & 0xFFFFu, t.radiance.g);
    return t;
}

/* The four corners of a cell. */
typedef struct {
    environment_texel t00, t10, t01, t11; /* t10: the next column; t01: the next row */
    GRADUS_NOT_IN_REGISTERS
} environment_corners;

GRADUS_FN environment_corners environment_cell(GRADUS_GLOBAL const uint *environment_texels, uint environment_columns,
                                               uint column, uint row, uint unit) {
    /* A row has one texel more than the map: its first again. */
    const uint above = row * (environment_columns + 1u) + column, below = above + environment_columns + 1u;
    environment_corners c;
    c.t00 = environment_load(environment_texels, above, unit, R(0));
    c.t10 = environment_load(environment_texels, above + 1u, unit, c.t00.radiance.b);
    c.t01 = environment_load(environment_texels, below, unit, c.t10.radiance.b);
    c.t11 = environment_load(environment_texels, below + 1u, unit, c.t01.radiance.b);
    return c;
}

/* Between four numbers, after `before`. */
GRADUS_FN real environment_mix(real n00, real n10, real n01, real n11, real s, real t, real before) {
    const real above = n00 + r_after(s, before) * (n10 - n00);
    const real below = n01 + r_after(s, above) * (n11 - n01);
    return above + t * (below - above);
}

/* One number after the other, or they would be packed into vectors (kernels/lib/ordered.h). */
GRADUS_FN environment_texel environment_between(environment_corners c, real s, real t) {
    environment_texel e;
    e.importance = environment_mix(c.t00.importance, c.t10.importance, c.t01.importance, c.t11.importance, s, t, s);
    e.radiance.r =
        environment_mix(c.t00.radiance.r, c.t10.radiance.r, c.t01.radiance.r, c.t11.radiance.r, s, t, e.importance);
    e.radiance.g =
        environment_mix(c.t00.radiance.g, c.t10.radiance.g, c.t01.radiance.g, c.t11.radiance.g, s, t, e.radiance.r);
    e.radiance.b =
        environment_mix(c.t00.radiance.b, c.t10.radiance.b, c.t01.radiance.b, c.t11.radiance.b, s, t, e.radiance.g);
    return e;
}

/* What a direction sees, and the density by solid angle with which environment_sample() finds it. */
typedef struct {
    rgb radiance;
    real pdf;
    GRADUS_NOT_IN_REGISTERS
} environment_light_value;

/* At the poles themselves the density has no bound; it is that of a millionth beside them. No quotient of two numbers,
 * or it would be packed with that of a Beckmann distribution (kernels/lib/ordered.h). */
GRADUS_FN real environment_pdf(real importance, real scale, real sine) {
    return importance * scale * (R(1) / r_max(sine, R(1e-6)));
}

#if TRAIT_LIGHT_ENVIRONMENT
/* direction: in the map's frame, of unit length. scale: see above. Where there is no map (environment_rows is 0) what
 * is returned has no meaning. */
GRADUS_FN environment_light_value environment_lookup(vec3 direction, real scale, uint unit ENVIRONMENT_PARAMETERS) {
    (void)environment_cells, (void)environment_strips, (void)environment_strip_count;
    const real sine = r_sqrt(direction.x * direction.x + direction.z * direction.z);
    const real along = approx_turn(direction.x, -direction.z) * (real)environment_columns - R(0.5);
    const real place = along < R(0) ? along + (real)environment_columns : along;
    const real from_pole = approx_turn(r_after(sine, place), r_after(direction.y, place));
    const real height = R(2) * from_pole * (real)environment_rows;
    const uint column = min((uint)place, environment_columns - 1u);
    const uint row = min((uint)height, max(environment_rows, 1u) - 1u);
    const environment_corners corners = environment_cell(environment_texels, environment_columns, column, row, unit);
    const environment_texel e = environment_between(corners, place - (real)column, height - (real)row);
    environment_light_value found;
    found.radiance = e.radiance;
    found.pdf = environment_pdf(e.importance, scale, sine);
    return found;
}
#endif

/* Where x lies for a number u of [0, 1) if its density on [0, 1] goes linearly from a to b. */
GRADUS_FN real environment_linear(real a, real b, real u) {
    const real root = r_sqrt(r_max(a * a + u * (b * b - a * a), R(0)));
    return r_min(u * (a + b) / r_max(a + root, R(1e-30)), R(1));
}

typedef struct {
    vec3 direction; /* in the map's frame, unit length */
    rgb radiance;
    real pdf; /* solid angle */
    GRADUS_NOT_IN_REGISTERS
} environment_choice;

#if TRAIT_LIGHT_ENVIRONMENT
/* The cell by a hash of three of the numbers, since one of 24 bits does not tell the cells of a large map apart; the
 * place in it by u.c and u.d. */
GRADUS_FN environment_choice environment_sample(random4 u, real scale, uint unit ENVIRONMENT_PARAMETERS) {
    /* Each number in a way of its own, or they would be packed (kernels/lib/ordered.h). */
    const random_bits bits =
        random_hash(as_uint((float)u.a), (uint)(u.b * R(16777216)), as_uint((float)(u.c + R(1))), 0x656E7669u);
    const uint drawn = mul_hi(bits.x, environment_strip_count);
    const int place = (int)(drawn * 2u);
    const uint limit = environment_strips[place], other = (environment_strips + unit)[place];
    const uint strip = bits.y < limit ? drawn : other;
    const uint drawn_cell = bits.z >> 24;
    const uint cell = environment_cells[(int)(strip * environment_strip + drawn_cell)];
    const uint in_strip = (bits.w >> 8) < (cell >> 8) ? drawn_cell : (cell & 255u);
    /* A division in real, for vector units have no other: exact, as there are fewer than 2^22 strips. */
    const uint strips_a_row = (environment_columns + environment_strip - 1u) / environment_strip;
    const uint row = min((uint)(((real)strip + R(0.5)) / (real)strips_a_row), max(environment_rows, 1u) - 1u);
    const uint column = min((strip - row * strips_a_row) * environment_strip + in_strip, environment_columns - 1u);
    const environment_corners c = environment_cell(environment_texels, environment_columns, column, row, unit);
    /* One after the other, here too. */
    const real above = c.t00.importance + c.t10.importance;
    const real below = r_after(c.t01.importance, above) + c.t11.importance;
    const real t = environment_linear(above, below, u.d);
    const real left = c.t00.importance + t * (c.t01.importance - c.t00.importance);
    const real right = c.t10.importance + r_after(t, left) * (c.t11.importance - c.t10.importance);
    const real s = environment_linear(left, right, u.c);
    const environment_texel e = environment_between(c, s, t);
    const real along = ((real)column + s + R(0.5)) / (real)environment_columns;
    const sine_cosine turn = approx_sine_cosine_2pi(along < R(1) ? along : along - R(1));
    const sine_cosine from_pole = approx_sine_cosine_2pi(R(0.5) * ((real)row + r_after(t, turn.sine + turn.cosine)) /
                                                         (real)max(environment_rows, 1u));
    environment_choice chosen;
    chosen.direction = v3(from_pole.sine * turn.sine, from_pole.cosine, -from_pole.sine * turn.cosine);
    chosen.radiance = e.radiance;
    chosen.pdf = environment_pdf(e.importance, scale, from_pole.sine);
    return chosen;
}
#endif

GRADUS_LIB_END
#endif
