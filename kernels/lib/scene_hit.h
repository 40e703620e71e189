/* Where and from which side a ray meets a primitive of the scene. */
#ifndef GRADUS_LIB_SCENE_HIT_H
#define GRADUS_LIB_SCENE_HIT_H
//! traits: TRAIT_SPHERES TRAIT_TRIANGLES
#include "kernels/lib/primitive.h"

GRADUS_LIB_BEGIN

/* The hit of a ray with the primitive that the tracer named. Independent ifs, not if and else: PoCL vectorises those.
 */
GRADUS_FN primitive_hit primitive_hit_of(GRADUS_GLOBAL const real *triangles, GRADUS_GLOBAL const real *spheres,
                                         uint unit, uint triangle_count, uint primitive, vec3 origin, vec3 direction) {
    primitive_hit hit;
    hit.u = R(0);
    hit.v = R(0);
    hit.position = origin;
    hit.normal = direction;
    (void)triangles, (void)spheres, (void)triangle_count;
#if TRAIT_TRIANGLES && TRAIT_SPHERES
    if (primitive < triangle_count)
#endif
#if TRAIT_TRIANGLES
        hit = triangle_hit(FIELD_V3(triangle, triangles, primitive, p0), FIELD_V3(triangle, triangles, primitive, e1),
                           FIELD_V3(triangle, triangles, primitive, e2), origin, direction);
#endif
#if TRAIT_TRIANGLES && TRAIT_SPHERES
    if (primitive >= triangle_count)
#endif
#if TRAIT_SPHERES
    {
        const uint sphere = primitive - triangle_count;
        hit = sphere_hit(FIELD_V3(sphere, spheres, sphere, center), FIELD_OF(sphere, spheres, sphere, radius),
                         FIELD_OF(sphere, spheres, sphere, facing), origin, direction);
    }
#endif
    return hit;
}

/* How far rays start off a primitive. */
GRADUS_FN real primitive_offset(GRADUS_GLOBAL const real *triangles, GRADUS_GLOBAL const real *spheres, uint unit,
                                uint triangle_count, uint primitive) {
    real offset = R(0);
    (void)triangles, (void)spheres, (void)triangle_count;
#if TRAIT_TRIANGLES && TRAIT_SPHERES
    if (primitive < triangle_count)
#endif
#if TRAIT_TRIANGLES
        offset = FIELD_OF(triangle, triangles, primitive, offset);
#endif
#if TRAIT_TRIANGLES && TRAIT_SPHERES
    if (primitive >= triangle_count)
#endif
#if TRAIT_SPHERES
        offset = FIELD_OF(sphere, spheres, primitive - triangle_count, offset);
#endif
    return offset;
}

/* 1 where the ray arrives against the geometric normal's back. */
GRADUS_FN int primitive_is_behind(GRADUS_GLOBAL const real *triangles, GRADUS_GLOBAL const real *spheres, uint unit,
                                  uint triangle_count, uint primitive, vec3 origin, vec3 direction) {
    return v3_dot(primitive_hit_of(triangles, spheres, unit, triangle_count, primitive, origin, direction).normal,
                  direction) > R(0);
}

GRADUS_LIB_END
#endif
