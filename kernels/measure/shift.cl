/* Shifts of gradient-domain methods and their Jacobians. */
#include "kernels/lib/shift_reconnection.h"
#include "kernels/lib/shift_specular.h"
#include "kernels/measure/function.h"

/* In: base, offset, target, its normal. */
STAGE measure_reconnection(MEASURE_ARGUMENTS) {
    MEASURE_ITEM
    OUT(0) = reconnection_jacobian(IN_V3(0), IN_V3(3), IN_V3(6), IN_V3(9));
}

/* In: wi and wo of the base, wi of the offset, index ratios of both. Out: Jacobian, wo, whether it succeeds. */
STAGE measure_half_vector(MEASURE_ARGUMENTS) {
    MEASURE_ITEM
    const shifted_direction s = shift_half_vector(IN_V3(0), IN_V3(3), IN(9), IN_V3(6), IN(10));
    OUT(0) = s.jacobian;
    OUT_V3(1, s.wo);
    OUT(4) = s.is_valid ? R(1) : R(0);
}

STAGE measure_specular(MEASURE_ARGUMENTS) {
    MEASURE_ITEM
    const shifted_direction s = shift_specular(IN_V3(0), IN_V3(3), IN_V3(6), IN(10));
    OUT(0) = s.jacobian;
    OUT_V3(1, s.wo);
    OUT(4) = s.is_valid ? R(1) : R(0);
}
