/* Sums that lose nothing to rounding: sum + correction is the value (Neumaier 1974, without the branch: Knuth's
 * two-sum gives the error of an addition exactly, whichever operand is larger). */
#ifndef GRADUS_LIB_COMPENSATED_H
#define GRADUS_LIB_COMPENSATED_H
#include "kernels/shared/compat.h"

GRADUS_LIB_BEGIN

typedef struct {
    real sum, correction;
    GRADUS_NOT_IN_REGISTERS
} compensated;

GRADUS_FN compensated compensated_add(compensated s, real x) {
    const real sum = s.sum + x;
    const real virtual_x = sum - s.sum;
    const real error = (s.sum - (sum - virtual_x)) + (x - virtual_x);
    compensated result;
    result.sum = sum;
    result.correction = s.correction + error;
    return result;
}

GRADUS_LIB_END
#endif
