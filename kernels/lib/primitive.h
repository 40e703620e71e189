/* Where a ray meets a primitive that the tracer has named. The tracer's own distance and barycentrics are not used:
 * computing them here makes a result independent of how rays were packed, and exact for spheres. */
#ifndef GRADUS_LIB_PRIMITIVE_H
#define GRADUS_LIB_PRIMITIVE_H
//! traits: TRAIT_INDEXED TRAIT_INSTANCES
#include "kernels/lib/vector.h"
#include "kernels/shared/scene_records.h"

GRADUS_LIB_BEGIN

typedef struct {
    vec3 position;
    vec3 normal; /* geometric, unit length */
    real u, v;   /* triangles: barycentric weights of the second and third vertex */
#if TRAIT_INDEXED
    uint corner_0, corner_1, corner_2; /* triangles: their vertices */
#endif
#if TRAIT_INSTANCES
    uint instance;
#endif
} primitive_hit;

/* The point on the plane of triangle (p0, e1, e2) along (origin, direction), by Cramer's rule as Moeller and Trumbore
 * (1997) have it. Twice the area times the unit normal is e1 x e2. */
GRADUS_FN primitive_hit triangle_hit(vec3 p0, vec3 e1, vec3 e2, vec3 origin, vec3 direction) {
    const vec3 area_normal = v3_cross(e1, e2);
    const vec3 to_origin = v3_sub(origin, p0);
    const vec3 p = v3_cross(direction, e2);
    const vec3 q = v3_cross(to_origin, e1);
    const real determinant = v3_dot(e1, p);
    const real inverse = R(1) / (determinant == R(0) ? R(1) : determinant);
    primitive_hit hit;
    hit.u = r_clamp(v3_dot(to_origin, p) * inverse, R(0), R(1));
    hit.v = r_clamp(v3_dot(direction, q) * inverse, R(0), R(1) - hit.u);
    hit.position = v3_mad(v3_mad(p0, hit.u, e1), hit.v, e2);
    hit.normal = v3_normalize(area_normal);
    return hit;
}

/* The nearest point in front of origin where the ray meets a sphere, or with a radius below 0 the farther one. The
 * discriminant is formed from the vector between center and line (Haines et al., Ray Tracing Gems, chapter 7), which
 * keeps its precision for small and far spheres; the point is then put back on the sphere. facing is 1 or -1. */
GRADUS_FN primitive_hit sphere_hit(vec3 center, real radius, real facing, vec3 origin, vec3 direction) {
    const vec3 f = v3_sub(origin, center);
    const real b = -v3_dot(f, direction);
    const vec3 closest = v3_mad(f, b, direction);
    const real discriminant = r_max(radius * radius - v3_dot(closest, closest), R(0));
    const int is_far_side = radius < R(0);
    const real c = v3_dot(f, f) - radius * radius;
    const real q = b + r_copysign1(b) * r_sqrt(discriminant);
    const real t_near = c / (q == R(0) ? R(1) : q);
    /* With q > 0 the roots are c / q <= q, else q <= c / q; an origin inside has c < 0. At the center b is 0. */
    const real t_nearest = (c > R(0)) == (q > R(0)) ? t_near : q;
    const real t = is_far_side ? r_max(t_near, q) : t_nearest;
    const vec3 normal = v3_normalize(v3_mad(f, t, direction));
    primitive_hit hit;
    hit.u = R(0);
    hit.v = R(0);
    hit.position = v3_mad(center, r_abs(radius), normal);
    hit.normal = v3_scale(normal, facing);
    return hit;
}

GRADUS_LIB_END
#endif
