/* The difference of an offset path and its base path. */
#ifndef GRADUS_LIB_WEIGHTED_DIFFERENCE_H
#define GRADUS_LIB_WEIGHTED_DIFFERENCE_H
#include "kernels/lib/vector.h"
#include "kernels/shared/tables.h"

/* What an offset path has more than its base path, weighted by all that find them (Kettunen et al. 2015). Densities are
 * over that of the base path's sampler: `base_other` of its other sampler, `offset_density` of the offset path's, times
 * the Jacobian. Where `marker` is shift_failed the base path counts for itself; where it is shift_absent nothing does.
 */
GRADUS_FN rgb weighted_difference(rgb base, rgb offset, real base_other, real offset_density, real marker) {
    const int failed = marker < shift_first_failed, absent = marker < shift_first_absent;
    const real weight = R(1) / (R(1) + base_other + (failed ? R(0) : offset_density));
    /* Selected, not scaled: an offset path that failed may have no value. */
    const rgb shifted = rgb_scale(offset, weight);
    return rgb_sub(rgb3(failed ? R(0) : shifted.r, failed ? R(0) : shifted.g, failed ? R(0) : shifted.b),
                   rgb_scale(base, absent ? R(0) : weight));
}

#endif
