/* Offset paths of gradient-domain path tracing: which neighbour they go through, and where they stand while they are
 * not connected with their base path. */
#ifndef GRADUS_LIB_GRADIENT_H
#define GRADUS_LIB_GRADIENT_H
//! traits: TRAIT_APART
#include "kernels/lib/division.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/stage.h"

/* The part of the film that a pass covers, as kernel arguments: a strip of whole rows of one frame, or (strip_rows that
 * of the crop) several frames, one after the other. Slots follow the pixels. */
#define STRIP_PLACE                                                                                                    \
    uint strip_pixels, uint strip_multiplier, uint strip_shift, uint strip_first, uint width_multiplier,               \
        uint width_shift, uint crop_width, uint crop_height

typedef struct {
    uint x, y; /* of the crop */
    GRADUS_NOT_IN_REGISTERS
} film_pixel;

#define PIXEL_OF(slot)                                                                                                 \
    pixel_of(slot, strip_pixels, strip_multiplier, strip_shift, strip_first, width_multiplier, width_shift, crop_width)
GRADUS_FN film_pixel pixel_of(uint slot, uint strip_pixels, uint strip_multiplier, uint strip_shift, uint strip_first,
                              uint width_multiplier, uint width_shift, uint crop_width) {
    const uint number = slot - divide(slot, strip_multiplier, strip_shift) * strip_pixels;
    const uint row = divide(number, width_multiplier, width_shift);
    film_pixel pixel;
    pixel.x = number - row * crop_width;
    pixel.y = row + strip_first;
    return pixel;
}

/* The slot of neighbour j: right, left, below, above; `slot` itself where there is none. Above the first row of a strip
 * it is below 0, and below the last beyond the strip: only `primary`, whose slots begin a row earlier, has it. */
GRADUS_FN uint gradient_neighbour(uint slot, uint j, film_pixel pixel, uint width, uint height) {
    /* Arithmetic, not a choice among four, where j is not known to the compiler. */
    const int is_across = j < 2u, is_onward = (j & 1u) == 0u;
    const uint place = is_across ? pixel.x : pixel.y, size = is_across ? width : height;
    const uint distance = is_across ? 1u : width;
    const int exists = is_onward ? place + 1u < size : place > 0u;
    const uint onward = slot + distance, back = slot - distance;
    return exists ? (is_onward ? onward : back) : slot;
}

/* Vertices of offset paths that are not connected: `own_vertex`, whose columns are `own_rows` apart. Of first vertices
 * (`at_first`) it is `primary_vertex`, what the neighbours' own paths see, in rows by slot, `primary_shift` further on;
 * of later ones `offset_vertex`. */
#define OWN_VERTEX __global const real *own_vertex, uint own_rows, uint at_first, uint primary_shift

typedef struct {
    int row;      /* of own_vertex */
    int is_there; /* there is an offset path that has not failed */
    int is_own;   /* and it is not connected */
    real ratio;   /* as in `offset` */
    rgb value;    /* as in `offset` */
    GRADUS_NOT_IN_REGISTERS
} own_vertex_state;

/* A stage may be compiled for one of both. */
#if !TRAIT_APART
#undef AT_FIRST
#define AT_FIRST 1u
#elif !defined(AT_FIRST)
#define AT_FIRST at_first
#endif

/* Offset j of the base path in `base_row`. */
#define OWN_STATE(j, base_row, base_slot, pixel)                                                                       \
    own_state(j, (uint)(base_row), base_slot, pixel, own_vertex, own_rows, AT_FIRST, primary_shift, crop_width,        \
              crop_height, capacity, offset)
GRADUS_FN own_vertex_state own_state(uint j, uint base_row, uint slot, film_pixel pixel,
                                     GRADUS_GLOBAL const real *own_vertex, uint own_rows, uint at_first,
                                     uint primary_shift, uint crop_width, uint crop_height, uint capacity,
                                     GRADUS_GLOBAL const real *offset) {
    own_vertex_state state;
    const uint neighbour = gradient_neighbour(slot, j, pixel, crop_width, crop_height);
    const int later = (int)(j * capacity + base_row);
    state.row = at_first ? (int)(neighbour + primary_shift) : later;
    const uint kind = AT_UINT(own_vertex, kind, state.row);
    const real at_first_ratio = neighbour == slot   ? shift_absent
                                : kind == kind_none ? shift_failed(outcome_failed_at_once)
                                                    : R(1);
    state.ratio = at_first_ratio;
    state.value = rgb_gray(R(1));
    state.is_own = state.ratio >= R(0);
#if TRAIT_APART
    const real ratio = AT(offset, ratio, later);
    const uint connection = AT_UINT(offset, state, later);
    state.ratio = at_first ? at_first_ratio : ratio;
    state.value = rgb_select(at_first != 0u, state.value, AT_RGB(offset, value, later));
    state.is_own = (state.ratio >= R(0)) & (at_first || connection < connection_recent);
#endif
    state.is_there = state.ratio >= R(0);
    return state;
}

#endif
