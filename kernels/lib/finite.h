/* Is a number a number? By the bits: relaxed arithmetic may remove isfinite(). */
#ifndef GRADUS_LIB_FINITE_H
#define GRADUS_LIB_FINITE_H
#include "kernels/shared/compat.h"

/* As a float: what is too large for one is not finite either. */
GRADUS_FN int is_finite(real x) { return (as_uint((float)x) & 0x7F800000u) != 0x7F800000u; }

#endif
