/* Division by a number that is the same for a whole launch, and the pixel that a slot belongs to. */
#ifndef GRADUS_LIB_DIVISION_H
#define GRADUS_LIB_DIVISION_H
#include "kernels/shared/compat.h"

/* number / divisor for number < 2^31 by a multiplication (Granlund and Montgomery 1994): vector units cannot divide.
 * See invariant_division in runtime/wavefront/invariant_division.h, which makes `multiplier` and `shift`. */
GRADUS_FN uint divide(uint number, uint multiplier, uint shift) {
    return multiplier ? mul_hi(number, multiplier) >> shift : number;
}

#endif
