/* Which side of a surface a ray meets: that of the shading normal (so Mitsuba's `twosided`), whatever else is in the
 * scene. */
#ifndef GRADUS_LIB_SURFACE_SIDE_H
#define GRADUS_LIB_SURFACE_SIDE_H
//! traits: TRAIT_SHADING_NORMALS
#include "kernels/lib/scene_hit.h"

GRADUS_LIB_BEGIN

/* Unit vector, on the side of the surface's own front. */
GRADUS_FN vec3 shading_normal_at(GRADUS_GLOBAL const real *triangle_normals, uint unit, uint triangle_count,
                                 uint primitive, primitive_hit hit) {
    vec3 shading = hit.normal;
    (void)triangle_normals, (void)unit, (void)triangle_count, (void)primitive;
#if TRAIT_SHADING_NORMALS
    const uint smooth = TRIANGLE_OF(primitive);
    const vec3 interpolated =
        v3_normalize(v3_mad(v3_mad(v3_scale(FIELD_V3(normals, triangle_normals, smooth, n0), R(1) - hit.u - hit.v),
                                   hit.u, FIELD_V3(normals, triangle_normals, smooth, n1)),
                            hit.v, FIELD_V3(normals, triangle_normals, smooth, n2)));
    shading = v3_select(!TRAIT_SPHERES || primitive < triangle_count, interpolated, shading);
#endif
    return shading;
}

/* 1 where a ray in that direction has met the primitive from behind. */
GRADUS_FN int is_met_from_behind(GRADUS_GLOBAL const real *triangle_normals, uint unit, uint triangle_count,
                                 uint primitive, primitive_hit hit, vec3 direction) {
    return v3_dot(shading_normal_at(triangle_normals, unit, triangle_count, primitive, hit), direction) > R(0);
}

/* The same of the ray's primitive that the tracer named. */
GRADUS_FN int primitive_is_behind(GRADUS_GLOBAL const real *triangles, GRADUS_GLOBAL const real *triangle_normals,
                                  GRADUS_GLOBAL const real *spheres, uint unit, uint triangle_count, uint primitive,
                                  vec3 origin, vec3 direction) {
    return is_met_from_behind(triangle_normals, unit, triangle_count, primitive,
                              primitive_hit_of(triangles, spheres, unit, triangle_count, primitive, origin, direction),
                              direction);
}

GRADUS_LIB_END
#endif
