/* frame: keeps the samples of slots `first_slot` on, which are of one frame, as those of the pixels from `first_pixel`
 * on: `accumulate` reads them once those around are there. */
//! traits: TRAIT_AOV
#include "kernels/lib/seen_features.h"
#include "kernels/shared/stage.h"

STAGE frame(uint count, uint slots, uint pixels, uint first_slot, uint first_pixel, __global const real *radiance,
            __global real *frame
#if TRAIT_AOV
            ,
            __global const real *feature
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t slot = (size_t)first_slot + i, pixel = (size_t)first_pixel + i;
    SET_RGB(frame, value, pixel, AT_RGB(radiance, value, slot));
#if TRAIT_AOV
    SET_RGB(frame, albedo, pixel, SEEN_ALBEDO(slot));
    SET_V3(frame, normal, pixel, SEEN_NORMAL(slot));
    AT(frame, depth, pixel) = SEEN_DEPTH(slot);
#endif
}
