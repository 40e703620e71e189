/* Pixel filters with negative lobes, by a table that follows the camera's record. */
#ifndef GRADUS_LIB_FILTER_TABLE_H
#define GRADUS_LIB_FILTER_TABLE_H
#include "kernels/shared/scene_records.h"

GRADUS_LIB_BEGIN

/* The table: filter_cells + 1 offsets in pixels, between each two of which a sample is as likely; then of each cell the
 * weights at its two ends, the filter over the density of samples there. */
#define filter_cells 4096u
#define filter_table_size (3u * filter_cells + 1u)

typedef struct {
    real offset; /* from the pixel's center, in pixels */
    real weight; /* negative in the negative lobes; their mean is 1 */
    GRADUS_NOT_IN_REGISTERS
} filter_sample;

/* Draws along one axis by |filter|. u in [0, 1). */
GRADUS_FN filter_sample filter_table_sample(GRADUS_GLOBAL const real *camera, uint unit, real u) {
    const real place = u * (real)filter_cells;
    const uint whole = (uint)place;
    const uint cell = whole < filter_cells ? whole : filter_cells - 1u;
    const size_t first = (size_t)(camera_stride + cell) * unit;
    const real from = camera[first], to = camera[first + unit];
    filter_sample drawn;
    const size_t weights = (size_t)(camera_stride + filter_cells + 1u + 2u * cell) * unit;
    const real at_from = camera[weights], at_to = camera[weights + unit], share = place - (real)cell;
    drawn.offset = from + share * (to - from);
    drawn.weight = at_from + share * (at_to - at_from);
    return drawn;
}

GRADUS_LIB_END
#endif
