/* A triangle of the scene: of a record of its own, or of vertices that it shares with others. */
#ifndef GRADUS_LIB_SCENE_TRIANGLE_H
#define GRADUS_LIB_SCENE_TRIANGLE_H
//! traits: TRAIT_INDEXED TRAIT_INSTANCES
#include "kernels/lib/instance.h"
#include "kernels/lib/ordered.h"
#include "kernels/lib/vector.h"
#include "kernels/shared/scene_records.h"

GRADUS_LIB_BEGIN

typedef struct {
    vec3 p0, e1, e2;
#if TRAIT_INDEXED
    uint corner_0, corner_1, corner_2;
#endif
} scene_triangle;

#if TRAIT_INDEXED
/* A number of a vertex, as FIELD_OF for records. */
#define vertex_normal 3
#define vertex_u (TRAIT_INDEXED - 2)
#define vertex_v (TRAIT_INDEXED - 1)
#define OF_VERTEX(array, vertex, place) ((array) + (place) * (size_t)unit)[(int)((uint)(vertex) * (uint)TRAIT_INDEXED)]
#define OF_VERTEX_V3(array, vertex, place)                                                                             \
    v3(OF_VERTEX(array, vertex, place), OF_VERTEX(array, vertex, (place) + 1), OF_VERTEX(array, vertex, (place) + 2))
/* A vertex of a triangle; array: `triangles`, or another of its names. */
#define CORNER_OF(array, triangle, corner)                                                                             \
    ((GRADUS_GLOBAL const uint *)(array) + (corner) * (size_t)unit)[(int)(3u * (uint)(triangle))]
#endif

GRADUS_FN scene_triangle scene_triangle_of(GRADUS_GLOBAL const real *triangles, uint unit,
                                           uint triangle INSTANCE_PARAMETER) {
    scene_triangle found;
#if TRAIT_INDEXED
    found.corner_0 = CORNER_OF(triangles, triangle, 0);
    found.corner_1 = CORNER_OF(triangles, triangle, 1);
    found.corner_2 = CORNER_OF(triangles, triangle, 2);
    found.p0 = OF_VERTEX_V3(triangles, found.corner_0, 0);
    found.e1 = v3_sub(OF_VERTEX_V3(triangles, found.corner_1, 0), found.p0);
    found.e2 = v3_sub(OF_VERTEX_V3(triangles, found.corner_2, 0), found.p0);
#if TRAIT_INSTANCES
    const instance_map map = instance_map_of(triangles, unit, instance);
    found.p0 = placed_point(map, found.p0);
    found.e1 = placed_vector(map, found.e1);
    found.e2 = placed_vector(map, found.e2);
#endif
#else
    found.p0 = FIELD_V3(triangle, triangles, triangle, p0);
    found.e1 = FIELD_V3(triangle, triangles, triangle, e1);
    found.e2 = FIELD_V3(triangle, triangles, triangle, e2);
#endif
    return found;
}

/* What the tracer errs by in meeting a primitive, relative to its size: 4 units of 2^-24, four times what was found
 * (tests/trace/self_hit_test.cpp). */
#define GRADUS_TRACER_ERROR R(2.384185791015625e-7)
/* Times the edges' product over the doubled area where that is large; found: a fifth of it. Of longer splinters than
 * most_slant some rays are caught. */
#define GRADUS_LEAST_SLANT R(4)
#define GRADUS_MOST_SLANT R(1024)

/* What a triangle adds to how far rays start off it. */
GRADUS_FN real triangle_offset_of(vec3 e1, vec3 e2) {
    const vec3 area_normal = v3_cross(e1, e2), e3 = v3_sub(e2, e1);
    const real square = v3_dot(area_normal, area_normal);
    /* One after the other (kernels/lib/ordered.h). */
    const real first = v3_dot(e1, e1), second = r_after(v3_dot(e2, e2), first), third = r_after(v3_dot(e3, e3), second);
    const real slant = r_sqrt(first * (second / (square > R(0) ? square : R(1))));
    const real longest = r_sqrt(r_after(r_max(r_max(first, second), third), slant));
    const real times = r_clamp((square > R(0) ? slant : GRADUS_MOST_SLANT) * (R(1) / GRADUS_LEAST_SLANT), R(1),
                               GRADUS_MOST_SLANT / GRADUS_LEAST_SLANT);
    return GRADUS_TRACER_ERROR * longest * times;
}

GRADUS_LIB_END
#endif
