/* Angles of directions. */
#ifndef GRADUS_LIB_ANGLE_H
#define GRADUS_LIB_ANGLE_H
#include "kernels/lib/ordered.h"

GRADUS_LIB_BEGIN

/* The angle of (x, y) from (1, 0) on, in turns: [0, 1). Absolute error below 1e-7 in float, 1e-9 in double; 0 at the
 * origin. Within an eighth of a turn of the diagonal the arc is that of (t - 1) / (t + 1) less an eighth, so that the
 * polynomial (fitted, least largest error) covers |t| <= tan(pi / 8). */
GRADUS_FN real angle_in_turns(real x, real y) {
    /* No two expressions alike: kernels/lib/ordered.h. */
    const real wide = r_abs(x), high = r_sqrt(y * y);
    const real most = r_max(wide, high), least = (wide + high) - most;
    const real is_diagonal = least > R(0.41421356237309503) * most ? R(1) : R(0);
    const real above = least - is_diagonal * most, below = most + r_after(is_diagonal, above) * least;
    const real t = above / (below > R(0) ? below : R(1));
    const real z = t * t;
    real p = R(0.0123099361487);
    p = p * z - R(0.0218914661096);
    p = p * z + R(0.0317704557358);
    p = p * z - R(0.0530498504986);
    p = p * z + R(0.159154928066);
    const real eighth = R(0.125) * is_diagonal + p * t;
    const real quarter = high > wide ? R(0.25) - eighth : eighth;
    const real half_turn = x < R(0) ? R(0.5) - quarter : quarter;
    const real turn = y < R(0) ? R(1) - half_turn : half_turn;
    return turn < R(1) ? turn : R(0);
}

GRADUS_LIB_END
#endif
