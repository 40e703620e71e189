/* Three-component vectors and colours as plain scalars: CPU implementations of OpenCL vectorise over
 * work-items, and their float3 stops that (measured on PoCL 3.1: six times slower). */
#ifndef GRADUS_LIB_VECTOR_H
#define GRADUS_LIB_VECTOR_H
#include "kernels/shared/compat.h"

GRADUS_LIB_BEGIN

typedef struct {
    real x, y, z;
    GRADUS_NOT_IN_REGISTERS
} vec3;

typedef struct {
    real r, g, b;
    GRADUS_NOT_IN_REGISTERS
} rgb;

GRADUS_FN vec3 v3(real x, real y, real z) {
    vec3 v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}
GRADUS_FN vec3 v3_add(vec3 a, vec3 b) { return v3(a.x + b.x, a.y + b.y, a.z + b.z); }
GRADUS_FN vec3 v3_sub(vec3 a, vec3 b) { return v3(a.x - b.x, a.y - b.y, a.z - b.z); }
GRADUS_FN vec3 v3_scale(vec3 a, real s) { return v3(a.x * s, a.y * s, a.z * s); }
GRADUS_FN vec3 v3_neg(vec3 a) { return v3(-a.x, -a.y, -a.z); }
/* a + s b */
GRADUS_FN vec3 v3_mad(vec3 a, real s, vec3 b) { return v3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z); }
GRADUS_FN real v3_dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
GRADUS_FN vec3 v3_cross(vec3 a, vec3 b) {
    return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
/* The largest of the absolute values of its coordinates. */
GRADUS_FN real v3_largest(vec3 a) { return r_max(r_abs(a.x), r_max(r_abs(a.y), r_abs(a.z))); }
GRADUS_FN real v3_length_squared(vec3 a) { return v3_dot(a, a); }
GRADUS_FN vec3 v3_normalize(vec3 a) { return v3_scale(a, R(1) / r_sqrt(v3_dot(a, a))); }

/* a where `first`, else b: a choice that needs no branch. */
GRADUS_FN vec3 v3_select(int first, vec3 a, vec3 b) {
    return v3(first ? a.x : b.x, first ? a.y : b.y, first ? a.z : b.z);
}

GRADUS_FN rgb rgb3(real r, real g, real b) {
    rgb c;
    c.r = r;
    c.g = g;
    c.b = b;
    return c;
}
GRADUS_FN rgb rgb_gray(real x) { return rgb3(x, x, x); }
GRADUS_FN rgb rgb_sub(rgb a, rgb b) { return rgb3(a.r - b.r, a.g - b.g, a.b - b.b); }
GRADUS_FN rgb rgb_add(rgb a, rgb b) { return rgb3(a.r + b.r, a.g + b.g, a.b + b.b); }
GRADUS_FN rgb rgb_mul(rgb a, rgb b) { return rgb3(a.r * b.r, a.g * b.g, a.b * b.b); }
GRADUS_FN rgb rgb_scale(rgb a, real s) { return rgb3(a.r * s, a.g * s, a.b * s); }
GRADUS_FN rgb rgb_select(int first, rgb a, rgb b) {
    return rgb3(first ? a.r : b.r, first ? a.g : b.g, first ? a.b : b.b);
}
GRADUS_FN real rgb_max(rgb a) { return r_max(a.r, r_max(a.g, a.b)); }

/* Of linear sRGB. */
GRADUS_FN real rgb_luminance(rgb c) { return R(0.212671) * c.r + R(0.715160) * c.g + R(0.072169) * c.b; }

GRADUS_LIB_END
#endif
