/* Sums in twice the precision: sum + correction is the value (Dekker 1971; Knuth's two-sum gives the error of an
 * addition exactly, whichever operand is larger). */
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
    /* The correction is kept below the last place of the sum: left to grow, it would lose what it is there to keep. */
    const real correction = s.correction + error;
    compensated result;
    result.sum = sum + correction;
    result.correction = correction - (result.sum - sum);
    return result;
}

GRADUS_LIB_END
#endif
