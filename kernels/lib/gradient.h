/* Offset paths of gradient-domain path tracing: which neighbour they go through, and where they are until they
 * reconnect. */
#ifndef GRADUS_LIB_GRADIENT_H
#define GRADUS_LIB_GRADIENT_H
//! traits: TRAIT_ANISOTROPIC TRAIT_SHADING_NORMALS TRAIT_APART
#include "kernels/lib/division.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/stage.h"

/* The film as kernel arguments: slots follow the pixels, frame after frame. */
#define FILM_PLACE                                                                                                     \
    uint pixels, uint pixels_multiplier, uint pixels_shift, uint width_multiplier, uint width_shift, uint crop_width,  \
        uint crop_height

typedef struct {
    uint x, y;
    GRADUS_NOT_IN_REGISTERS
} film_pixel;

#define PIXEL_OF(slot)                                                                                                 \
    pixel_of(slot, pixels, pixels_multiplier, pixels_shift, width_multiplier, width_shift, crop_width)
GRADUS_FN film_pixel pixel_of(uint slot, uint pixels, uint pixels_multiplier, uint pixels_shift, uint width_multiplier,
                              uint width_shift, uint crop_width) {
    const uint number = slot - divide(slot, pixels_multiplier, pixels_shift) * pixels;
    film_pixel pixel;
    pixel.y = divide(number, width_multiplier, width_shift);
    pixel.x = number - pixel.y * crop_width;
    return pixel;
}

/* The slot of neighbour j: right, left, below, above; `slot` itself where there is none. */
GRADUS_FN uint gradient_neighbour(uint slot, uint j, film_pixel pixel, uint width, uint height) {
    return j == 0u   ? (pixel.x + 1u < width ? slot + 1u : slot)
           : j == 1u ? (pixel.x > 0u ? slot - 1u : slot)
           : j == 2u ? (pixel.y + 1u < height ? slot + width : slot)
                     : (pixel.y > 0u ? slot - width : slot);
}

/* The vertices of offset paths that have not reconnected: a table, and its row for offset j of a base path. Where all
 * reconnect at the first chance these are what the neighbours' own paths see. */
#if TRAIT_APART
#define LONE offset_vertex
#define LONE_ROW(j, row, neighbour) ((size_t)(j)*capacity + (row))
#else
#define LONE primary
#define LONE_ROW(j, row, neighbour) (neighbour)
#endif
#if TRAIT_SHADING_NORMALS
#define LONE_NORMAL(at) AT_V3(LONE, shading, at)
#else
#define LONE_NORMAL(at) AT_V3(LONE, geometric, at)
#endif
#if TRAIT_ANISOTROPIC
#define LONE_FRAME(at, m) frame_from_tangent(LONE_NORMAL(at), AT_V3(LONE, along, at), (m).alpha_u != (m).alpha_v)
#else
#define LONE_FRAME(at, m) frame_from_normal(LONE_NORMAL(at))
#endif

#endif
