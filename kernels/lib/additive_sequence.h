/* A sequence of places that fills the unit square evenly. */
#ifndef GRADUS_LIB_ADDITIVE_SEQUENCE_H
#define GRADUS_LIB_ADDITIVE_SEQUENCE_H
#include "kernels/lib/random.h"
#include "kernels/lib/warp.h"

GRADUS_LIB_BEGIN

/* Place `number` of the additive sequence (Roberts 2018) from a random start: even along either side too. */
GRADUS_FN point2 additive_sequence(uint start_x, uint start_y, uint number) {
    point2 place;
    place.x = random_unit(start_x + number * 3242174889u);
    place.y = random_unit(start_y + number * 2447445414u);
    return place;
}

GRADUS_LIB_END
#endif
