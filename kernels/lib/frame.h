/* Orthonormal frames: s and t tangent, n the normal; right-handed (s x t = n). */
#ifndef GRADUS_LIB_FRAME_H
#define GRADUS_LIB_FRAME_H
#include "kernels/lib/vector.h"

GRADUS_LIB_BEGIN

typedef struct {
    vec3 s, t, n;
} frame;

/* A frame around the unit vector n, without a branch (Duff et al. 2017, Building an Orthonormal Basis,
 * Revisited). The tangents jump only across n.z = 0. */
GRADUS_FN frame frame_from_normal(vec3 n) {
    frame f;
    const real sign = r_copysign1(n.z);
    const real a = R(-1) / (sign + n.z);
    const real b = n.x * n.y * a;
    f.s = v3(R(1) + sign * n.x * n.x * a, sign * b, -sign * n.x);
    f.t = v3(b, sign + n.y * n.y * a, -n.y);
    f.n = n;
    return f;
}

/* Components of the world vector v along s, t, n. */
GRADUS_FN vec3 frame_to_local(frame f, vec3 v) { return v3(v3_dot(v, f.s), v3_dot(v, f.t), v3_dot(v, f.n)); }

/* The world vector whose components along s, t, n are v. */
GRADUS_FN vec3 frame_to_world(frame f, vec3 v) {
    return v3(f.s.x * v.x + f.t.x * v.y + f.n.x * v.z, f.s.y * v.x + f.t.y * v.y + f.n.y * v.z,
              f.s.z * v.x + f.t.z * v.y + f.n.z * v.z);
}

GRADUS_LIB_END
#endif
