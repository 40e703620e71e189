/* Pixel filters other than a box: where within their pixels the samples of a frame lie, which all pixels share, and
 * what each of them weighs for the pixels around (runtime/scene/filter_table.h). */
#ifndef GRADUS_LIB_FILTER_TABLE_H
#define GRADUS_LIB_FILTER_TABLE_H
#include "kernels/shared/compat.h"

GRADUS_LIB_BEGIN

/* Along each axis the places within a pixel are so many cells, in each of which a sample is as likely. */
#define filter_cells 4096u

/* A place within a pixel along one axis: a cell, and how far in it, in [0, 1). */
typedef struct {
    uint cell;
    real share;
    GRADUS_NOT_IN_REGISTERS
} filter_place;

/* u in [0, 1). */
GRADUS_FN filter_place filter_place_of(real u) {
    const real place = u * (real)filter_cells;
    const uint whole = (uint)place;
    filter_place found;
    found.cell = whole < filter_cells ? whole : filter_cells - 1u;
    found.share = place - (real)found.cell;
    return found;
}

/* Such a place in one number, as kernels take it: the cell, of which there is one more (runtime/scene/filter_table.h),
 * and the share of it in filter_share_bits, more than it has. */
#define filter_share_bits 19u
GRADUS_FN uint filter_number(filter_place place) {
    return (place.cell << filter_share_bits) + (uint)(place.share * (real)(1u << filter_share_bits));
}
GRADUS_FN filter_place filter_place_at(uint number) {
    filter_place place;
    place.cell = number >> filter_share_bits;
    place.share = (real)(number & ((1u << filter_share_bits) - 1u)) * (R(1) / (real)(1u << filter_share_bits));
    return place;
}

/* From the pixel's center, in pixels; `filter_offsets` has those of the cells' borders. */
GRADUS_FN real filter_offset(GRADUS_GLOBAL const real *filter_offsets, filter_place place) {
    const real from = filter_offsets[place.cell], to = filter_offsets[place.cell + 1u];
    return from + place.share * (to - from);
}

/* What a sample at such a place weighs for the pixel `tap` - reach pixels away from its own, of taps 0 to 2 reach,
 * along that axis: by cell the weights at its beginning, and those at its end. All taps sum up to 1. */
GRADUS_FN real filter_tap(GRADUS_GLOBAL const real *filter_taps, uint reach, filter_place place, uint tap) {
    const uint taps = 2u * reach + 1u;
    const size_t first = (size_t)place.cell * (2u * taps) + tap;
    const real begin = filter_taps[first], end = filter_taps[first + taps];
    return begin + place.share * (end - begin);
}

GRADUS_LIB_END
#endif
