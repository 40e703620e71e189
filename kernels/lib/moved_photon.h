/* A place in `moved_index`: the pair and the offset. There are `pairs` pairs, all of offset 0 before those of 1. */
#ifndef GRADUS_LIB_MOVED_PHOTON_H
#define GRADUS_LIB_MOVED_PHOTON_H
#include "kernels/lib/shift_photon.h"
#include "kernels/shared/stage.h"

GRADUS_FN uint moved_offset(uint number, uint pairs) {
    return (number >= pairs ? 1u : 0u) + (number >= 2u * pairs ? 1u : 0u) + (number >= 3u * pairs ? 1u : 0u);
}

#define PHOTON_DISC(row)                                                                                               \
    photon_disc_of(AT_V3(gather, position, row), AT_V3(gather, geometric, row), AT(gather, radius, row))

#endif
