/* What a ray finds of a surface: where, and how it faces. */
#ifndef GRADUS_LIB_SURFACE_POINT_H
#define GRADUS_LIB_SURFACE_POINT_H
//! traits: TRAIT_SHADING_NORMALS TRAIT_ANISOTROPIC TRAIT_TWO_SIDED TRAIT_TWO_FACED TRAIT_INSTANCES
#include "kernels/lib/material_side.h"
#include "kernels/lib/surface_side.h"

GRADUS_LIB_BEGIN

/* Normals are unit vectors on the side that the material calls front. */
typedef struct {
    vec3 position, geometric, shading;
    vec3 along; /* dp/du, any length; only with TRAIT_ANISOTROPIC */
    real offset;
    uint material; /* record of the material on this side */
    GRADUS_NOT_IN_REGISTERS
} surface_point;

#if TRAIT_INDEXED && TRAIT_ANISOTROPIC
/* dp/du, of any length; zero where (u, v) do not tell, or are not the file's. */
GRADUS_FN vec3 tangent_of_corners(GRADUS_GLOBAL const real *vertices, uint unit, scene_triangle triangle) {
    const real u_0 = OF_VERTEX(vertices, triangle.corner_0, vertex_u);
    const real v_0 = OF_VERTEX(vertices, triangle.corner_0, vertex_v);
    const real u_1 = OF_VERTEX(vertices, triangle.corner_1, vertex_u) - u_0;
    const real v_1 = OF_VERTEX(vertices, triangle.corner_1, vertex_v) - v_0;
    const real u_2 = OF_VERTEX(vertices, triangle.corner_2, vertex_u) - u_0;
    const real v_2 = OF_VERTEX(vertices, triangle.corner_2, vertex_v) - v_0;
    const real determinant = u_1 * v_2 - u_2 * v_1;
    const int is_told = (determinant != R(0)) & (u_0 != (real)unit_first_u);
    const real sign = is_told ? r_copysign1(determinant) : R(0); /* only the direction counts */
    return v3_scale(v3_mad(v3_scale(triangle.e1, v_2), -v_1, triangle.e2), sign);
}
#endif

/* Where a ray in that direction has met the primitive. */
GRADUS_FN surface_point surface_point_at(GRADUS_GLOBAL const real *triangles,
                                         GRADUS_GLOBAL const real *triangle_normals,
                                         GRADUS_GLOBAL const real *triangle_tangents, GRADUS_GLOBAL const real *spheres,
                                         uint unit, uint triangle_count, GRADUS_GLOBAL const uint *primitive_material,
                                         GRADUS_GLOBAL const uint *material_back, uint primitive, primitive_hit hit,
                                         vec3 direction) {
    (void)triangle_tangents, (void)material_back, (void)direction;
    surface_point point;
    vec3 shading = shading_normal_at(triangle_normals, unit, triangle_count, primitive, hit);
    const uint sided_material = OF_PRIMITIVE(primitive_material, material, primitive);
    uint material_index = material_record(sided_material);
    vec3 geometric = hit.normal;
#if TRAIT_TWO_SIDED
    const int is_behind = v3_dot(shading, direction) > R(0);
    const int turned = (sided_material & material_two_sided) != 0u && is_behind;
#if TRAIT_TWO_FACED
    material_index = material_on_side(material_back, sided_material, is_behind);
#endif
    const real turn = turned ? R(-1) : R(1);
    geometric = v3_scale(geometric, turn);
    shading = v3_scale(shading, turn);
#endif
    point.along = v3(R(0), R(0), R(0));
#if TRAIT_ANISOTROPIC
#if TRAIT_SPHERES
    /* Around the pole; only the direction counts, not its sign. */
    point.along = v3_cross(FIELD_V3(sphere, spheres, SPHERE_OF(primitive), pole), hit.normal);
#endif
#if TRAIT_INDEXED
    const scene_triangle triangle = scene_triangle_of(triangles, unit, TRIANGLE_OF(primitive) INSTANCE_OF_HIT);
    const vec3 of_triangle = tangent_of_corners(triangle_tangents, unit, triangle);
#else
    const vec3 of_triangle = FIELD_V3(triangle_tangent, triangle_tangents, TRIANGLE_OF(primitive), along);
#endif
    point.along = v3_select(!TRAIT_SPHERES || primitive < triangle_count, of_triangle, point.along);
#endif
    point.position = hit.position;
    point.geometric = geometric;
    point.shading = shading;
    point.offset = offset_at(hit.position, hit.normal,
                             primitive_offset(triangles, spheres, unit, triangle_count, primitive HIT_ARGUMENT(hit)));
    point.material = material_index;
    return point;
}

GRADUS_FN surface_point surface_point_of(GRADUS_GLOBAL const real *triangles,
                                         GRADUS_GLOBAL const real *triangle_normals,
                                         GRADUS_GLOBAL const real *triangle_tangents, GRADUS_GLOBAL const real *spheres,
                                         uint unit, uint triangle_count, GRADUS_GLOBAL const uint *primitive_material,
                                         GRADUS_GLOBAL const uint *material_back, uint primitive INSTANCE_PARAMETER,
                                         vec3 origin, vec3 direction) {
    return surface_point_at(
        triangles, triangle_normals, triangle_tangents, spheres, unit, triangle_count, primitive_material,
        material_back, primitive,
        primitive_hit_of(triangles, spheres, unit, triangle_count, primitive INSTANCE_ARGUMENT, origin, direction),
        direction);
}

GRADUS_LIB_END
#endif
