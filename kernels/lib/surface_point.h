/* What a ray finds of a surface: where, and how it faces. */
#ifndef GRADUS_LIB_SURFACE_POINT_H
#define GRADUS_LIB_SURFACE_POINT_H
//! traits: TRAIT_SHADING_NORMALS TRAIT_ANISOTROPIC TRAIT_TWO_SIDED TRAIT_TWO_FACED
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
    const uint sided_material = primitive_material[primitive];
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
    point.along = v3(-hit.normal.y, hit.normal.x, R(0)); /* spheres: around the z axis */
#if TRAIT_ANISOTROPIC
    const vec3 of_triangle = FIELD_V3(triangle_tangent, triangle_tangents, TRIANGLE_OF(primitive), along);
    point.along = v3_select(!TRAIT_SPHERES || primitive < triangle_count, of_triangle, point.along);
#endif
    point.position = hit.position;
    point.geometric = geometric;
    point.shading = shading;
    point.offset =
        offset_at(hit.position, hit.normal, primitive_offset(triangles, spheres, unit, triangle_count, primitive));
    point.material = material_index;
    return point;
}

GRADUS_FN surface_point surface_point_of(GRADUS_GLOBAL const real *triangles,
                                         GRADUS_GLOBAL const real *triangle_normals,
                                         GRADUS_GLOBAL const real *triangle_tangents, GRADUS_GLOBAL const real *spheres,
                                         uint unit, uint triangle_count, GRADUS_GLOBAL const uint *primitive_material,
                                         GRADUS_GLOBAL const uint *material_back, uint primitive, vec3 origin,
                                         vec3 direction) {
    return surface_point_at(triangles, triangle_normals, triangle_tangents, spheres, unit, triangle_count,
                            primitive_material, material_back, primitive,
                            primitive_hit_of(triangles, spheres, unit, triangle_count, primitive, origin, direction),
                            direction);
}

GRADUS_LIB_END
#endif
