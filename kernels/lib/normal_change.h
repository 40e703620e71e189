/* How a shading normal changes along its surface. */
#ifndef GRADUS_LIB_NORMAL_CHANGE_H
#define GRADUS_LIB_NORMAL_CHANGE_H
#include "kernels/lib/ordered.h"
#include "kernels/lib/vector.h"

GRADUS_LIB_BEGIN

/* The derivative of a unit normal n with the point p on the surface, in world units:
 *     dn = curvature dp + (1 - n n^T) (along_u (u . dp) + along_v (v . dp)). */
typedef struct {
    vec3 n, u, v, along_u, along_v;
    real curvature;
} normal_change;

/* Of a flat surface without shading normals. */
GRADUS_FN normal_change normal_change_flat(vec3 n) {
    const vec3 zero = v3(R(0), R(0), R(0));
    normal_change c;
    c.n = n;
    c.u = c.v = c.along_u = c.along_v = zero;
    c.curvature = R(0);
    return c;
}

/* Of normals interpolated over a triangle with edges e1 and e2: n is along sum = (1 - u - v) n0 + u n1 + v n2, on the
 * side that `turn`, 1 or -1, says. With a = e1 x e2 barycentric weights change by du = dp . (e2 x a) / |a|^2 and
 * dv = dp . (a x e1) / |a|^2. */
GRADUS_FN normal_change normal_change_triangle(vec3 e1, vec3 e2, vec3 n0, vec3 n1, vec3 n2, real u, real v, real turn) {
    const vec3 area_normal = v3_cross(e1, e2);
    const real area_squared = v3_dot(area_normal, area_normal);
    const real inverse_area = R(1) / (area_squared == R(0) ? R(1) : area_squared);
    const vec3 sum = v3_mad(v3_mad(v3_scale(n0, R(1) - u - v), u, n1), v, n2);
    const real sum_squared = r_after(v3_dot(sum, sum), inverse_area);
    const real scale = turn / r_sqrt(sum_squared == R(0) ? R(1) : sum_squared);
    normal_change c;
    c.n = v3_scale(sum, scale);
    c.u = v3_scale(v3_cross(e2, area_normal), inverse_area);
    c.v = v3_scale(v3_cross(area_normal, e1), inverse_area);
    c.along_u = v3_scale(v3_sub(n1, n0), scale);
    c.along_v = v3_scale(v3_sub(n2, n0), scale);
    c.curvature = R(0);
    return c;
}

/* dn for a step dp within the surface. */
GRADUS_FN vec3 normal_change_along(normal_change c, vec3 dp) {
    const vec3 sum = v3_mad(v3_scale(c.along_u, v3_dot(c.u, dp)), v3_dot(c.v, dp), c.along_v);
    return v3_mad(v3_mad(sum, -v3_dot(c.n, sum), c.n), c.curvature, dp);
}

GRADUS_LIB_END
#endif
