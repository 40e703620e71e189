/* Which side of a surface a ray meets: that of the shading normal (so Mitsuba's `twosided`), whatever else is in the
 * scene. */
#ifndef GRADUS_LIB_SURFACE_SIDE_H
#define GRADUS_LIB_SURFACE_SIDE_H
//! traits: TRAIT_SHADING_NORMALS TRAIT_INSTANCES TRAIT_TWO_SIDED
#include "kernels/lib/scene_hit.h"

/* Whether there are surfaces whose frame turns with the side, and whose side may be another one than the geometric
 * normal's. */
#define SIDE_BY_SHADING (TRAIT_TWO_SIDED && TRAIT_SHADING_NORMALS)

GRADUS_LIB_BEGIN

typedef struct {
    vec3 n0, n1, n2;
} vertex_normals;

/* Shading normals at the vertices of the triangle that was hit; with TRAIT_INDEXED zero where its mesh has none. */
GRADUS_FN vertex_normals vertex_normals_of(GRADUS_GLOBAL const real *triangle_normals, uint unit, uint triangle,
                                           primitive_hit hit) {
    vertex_normals found;
    (void)triangle, (void)hit;
#if TRAIT_INDEXED
    found.n0 = OF_VERTEX_V3(triangle_normals, hit.corner_0, vertex_normal);
    found.n1 = OF_VERTEX_V3(triangle_normals, hit.corner_1, vertex_normal);
    found.n2 = OF_VERTEX_V3(triangle_normals, hit.corner_2, vertex_normal);
#else
    found.n0 = FIELD_V3(normals, triangle_normals, triangle, n0);
    found.n1 = FIELD_V3(normals, triangle_normals, triangle, n1);
    found.n2 = FIELD_V3(normals, triangle_normals, triangle, n2);
#endif
    return found;
}

/* Unit vector, on the side of the surface's own front. */
GRADUS_FN vec3 shading_normal_at(GRADUS_GLOBAL const real *triangle_normals, uint unit, uint triangle_count,
                                 uint primitive, primitive_hit hit) {
    vec3 shading = hit.normal;
    (void)triangle_normals, (void)unit, (void)triangle_count, (void)primitive;
#if TRAIT_SHADING_NORMALS
    const vertex_normals n = vertex_normals_of(triangle_normals, unit, TRIANGLE_OF(primitive), hit);
    vec3 sum = v3_mad(v3_mad(v3_scale(n.n0, R(1) - hit.u - hit.v), hit.u, n.n1), hit.v, n.n2);
#if TRAIT_INSTANCES
    sum = placed_normal(instance_map_of(triangle_normals, unit, hit.instance), sum);
#endif
#if TRAIT_INDEXED
    const vec3 interpolated = v3_select(v3_dot(sum, sum) > R(0), v3_normalize(sum), shading);
#else
    const vec3 interpolated = v3_normalize(sum);
#endif
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
                                  GRADUS_GLOBAL const real *spheres, uint unit, uint triangle_count,
                                  uint primitive INSTANCE_PARAMETER, vec3 origin, vec3 direction) {
    return is_met_from_behind(
        triangle_normals, unit, triangle_count, primitive,
        primitive_hit_of(triangles, spheres, unit, triangle_count, primitive INSTANCE_ARGUMENT, origin, direction),
        direction);
}

GRADUS_LIB_END
#endif
