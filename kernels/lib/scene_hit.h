/* Where and from which side a ray meets a primitive of the scene. */
#ifndef GRADUS_LIB_SCENE_HIT_H
#define GRADUS_LIB_SCENE_HIT_H
//! traits: TRAIT_SPHERES TRAIT_TRIANGLES TRAIT_INSTANCES
#include "kernels/lib/primitive.h"
#include "kernels/lib/ray_start.h"
#include "kernels/lib/scene_triangle.h"

GRADUS_LIB_BEGIN

/* Where the scene has triangles and spheres, a primitive's number as one of either; 0 where it is of the other. */
#define TRIANGLE_OF(primitive) (TRAIT_SPHERES ? ((primitive) < triangle_count ? (primitive) : 0u) : (primitive))
#define SPHERE_OF(primitive) r_not_negative((primitive)-triangle_count)

#if TRAIT_INSTANCES
/* Arguments that there are with instances alone. The primitive that a ray met, in a row of a table of rays, is followed
 * by that of its instance; where nothing was met that is one that nobody reads. */
#define INSTANCE_IN(pointer, table, row)                                                                               \
    , present_instance(AT_UINT_IN(pointer, table, primitive, row) < ray_first_special,                                 \
                       AT_UINT_IN(pointer, table, instance, row))
#define HIT_PARAMETER , primitive_hit hit
#define HIT_ARGUMENT(hit) , hit
#define INSTANCE_OF_HIT , hit.instance
#else
#define INSTANCE_IN(pointer, table, row)
#define HIT_PARAMETER
#define HIT_ARGUMENT(hit)
#define INSTANCE_OF_HIT
#endif

/* The hit of a ray with the primitive that the tracer named. Both kinds are computed where both occur: loads behind a
 * condition keep PoCL from vectorising (surface: 47 ns a row, 12 without). */
GRADUS_FN primitive_hit primitive_hit_of(GRADUS_GLOBAL const real *triangles, GRADUS_GLOBAL const real *spheres,
                                         uint unit, uint triangle_count, uint primitive INSTANCE_PARAMETER, vec3 origin,
                                         vec3 direction) {
    primitive_hit hit;
    (void)triangles, (void)spheres, (void)triangle_count;
#if TRAIT_TRIANGLES
    const scene_triangle triangle = scene_triangle_of(triangles, unit, TRIANGLE_OF(primitive) INSTANCE_ARGUMENT);
    hit = triangle_hit(triangle.p0, triangle.e1, triangle.e2, origin, direction);
#if TRAIT_INDEXED
    hit.corner_0 = triangle.corner_0;
    hit.corner_1 = triangle.corner_1;
    hit.corner_2 = triangle.corner_2;
#endif
#if TRAIT_INSTANCES
    hit.instance = instance;
    hit.normal = v3_scale(hit.normal, INSTANCE_FIELD(triangles, instance, facing));
#endif
#endif
#if TRAIT_SPHERES
    const uint sphere = SPHERE_OF(primitive);
    const primitive_hit on_sphere =
        sphere_hit(FIELD_V3(sphere, spheres, sphere, center), FIELD_OF(sphere, spheres, sphere, radius),
                   FIELD_OF(sphere, spheres, sphere, facing), origin, direction);
#endif
#if TRAIT_TRIANGLES && TRAIT_SPHERES
    const int is_triangle = primitive < triangle_count;
    hit.position = v3_select(is_triangle, hit.position, on_sphere.position);
    hit.normal = v3_select(is_triangle, hit.normal, on_sphere.normal);
#elif TRAIT_SPHERES
    hit = on_sphere;
#elif !TRAIT_TRIANGLES
    hit.u = R(0);
    hit.v = R(0);
    hit.position = origin;
    hit.normal = direction;
#endif
    return hit;
}

/* What a primitive adds to how far rays start off it (offset_at). */
GRADUS_FN real primitive_offset(GRADUS_GLOBAL const real *triangles, GRADUS_GLOBAL const real *spheres, uint unit,
                                uint triangle_count, uint primitive HIT_PARAMETER) {
    real offset = R(0);
    (void)triangles, (void)spheres, (void)triangle_count;
#if TRAIT_TRIANGLES
#if TRAIT_INDEXED
    const scene_triangle triangle = scene_triangle_of(triangles, unit, TRIANGLE_OF(primitive) INSTANCE_OF_HIT);
    offset = triangle_offset_of(triangle.e1, triangle.e2);
#if TRAIT_INSTANCES
    offset += instance_rounding(triangles, unit, hit.instance, hit.normal);
#endif
#else
    offset = FIELD_OF(triangle, triangles, TRIANGLE_OF(primitive), offset);
#endif
#endif
#if TRAIT_SPHERES
    const real of_sphere = FIELD_OF(sphere, spheres, SPHERE_OF(primitive), offset);
    offset = TRAIT_TRIANGLES && primitive < triangle_count ? offset : of_sphere;
#endif
    return offset;
}

GRADUS_LIB_END
#endif
