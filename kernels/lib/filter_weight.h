/* The weight that a sample has of a pixel filter with negative lobes: WEIGHTED(x) after FILTER_WEIGHT(slot); and what
 * such samples tell of their variance. */
#ifndef GRADUS_LIB_FILTER_WEIGHT_H
#define GRADUS_LIB_FILTER_WEIGHT_H
#include "kernels/shared/compat.h"
//! traits: TRAIT_FILTER_SIGNED

#if TRAIT_FILTER_SIGNED
#define FILTER_WEIGHT(slot) const real filter_weight = AT(filtered, weight, slot);
#define WEIGHTED(x) ((x)*filter_weight)

GRADUS_LIB_BEGIN

/* What a sample `value`, which is times its weight w, adds to a sum of squared deviations from the mean (Welford 1962).
 * Those before it have the sum `sum`, the sum W of their weights and V of the squares of these. Then w f - w mean has
 * w^2 (1 + V / W^2) times the variance of f: what is added has w^2 times that, and nothing is divided by W, which may
 * be near 0. */
GRADUS_FN real weighted_deviation(real weight, real weights, real squares, real value, real sum) {
    const real deviation = value * weights - weight * sum;
    return deviation * (deviation / r_max(weights * weights + squares, R(1e-30)));
}

GRADUS_LIB_END
#else
#define FILTER_WEIGHT(slot)
#define WEIGHTED(x) (x)
#endif

#endif
