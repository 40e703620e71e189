/* Sums of squared deviations from a mean, one sample after the other (Welford 1962): of a sum of squares the square of
 * the mean would be taken off, which leaves rounding where the spread is small beside it. */
#ifndef GRADUS_LIB_SQUARED_DEVIATION_H
#define GRADUS_LIB_SQUARED_DEVIATION_H
#include "kernels/shared/compat.h"

GRADUS_LIB_BEGIN

/* What a sample `value` adds, after so many before it, whose sum is `sum`. */
GRADUS_FN real squared_deviation(real before, real value, real sum) {
    const real deviation = value - sum * (R(1) / r_max(before, R(1)));
    return deviation * (deviation * (before / (before + R(1))));
}

GRADUS_LIB_END
#endif
