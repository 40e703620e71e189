/* The difference of an offset path and its base path. */
#ifndef GRADUS_LIB_WEIGHTED_DIFFERENCE_H
#define GRADUS_LIB_WEIGHTED_DIFFERENCE_H
#include "kernels/lib/vector.h"
#include "kernels/shared/tables.h"

/* What an offset path has more than its base path. Where `marker` is shift_failed the base path counts for itself;
 * where it is shift_absent nothing does. */
GRADUS_FN rgb difference_of(rgb base, rgb offset, real weight, real marker) {
    const int failed = marker < shift_first_failed, absent = marker < shift_first_absent;
    /* Selected, not scaled: an offset path that failed may have no value. */
    const rgb shifted = rgb_scale(offset, weight);
    return rgb_sub(rgb3(failed ? R(0) : shifted.r, failed ? R(0) : shifted.g, failed ? R(0) : shifted.b),
                   rgb_scale(base, absent ? R(0) : weight));
}

/* The share of the base path's sampler in all that find the two paths (Kettunen et al. 2015). Densities are over that
 * of the base path's sampler: `base_other` of its other sampler, `offset_density` of the offset path's, times the
 * Jacobian; of one that failed none. */
GRADUS_FN real weight_of_difference(real base_other, real offset_density, real marker) {
    return R(1) / (R(1) + base_other + (marker < shift_first_failed ? R(0) : offset_density));
}

/* A difference with that weight. */
GRADUS_FN rgb weighted_difference(rgb base, rgb offset, real base_other, real offset_density, real marker) {
    return difference_of(base, offset, weight_of_difference(base_other, offset_density, marker), marker);
}

#endif
