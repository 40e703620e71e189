/* Where on its own map (u, v) a ray has met a surface. */
#ifndef GRADUS_LIB_HIT_UV_H
#define GRADUS_LIB_HIT_UV_H
//! traits: TRAIT_SPHERES TRAIT_TRIANGLES
#include "kernels/lib/scene_hit.h"
#include "kernels/lib/surface_uv.h"

#if HAS_TEXTURES || !defined(__OPENCL_VERSION__)
GRADUS_LIB_BEGIN

/* The sphere_place() of a hit with a sphere. */
GRADUS_FN vec3 hit_sphere_place(GRADUS_GLOBAL const real *sphere_axes, GRADUS_GLOBAL const real *spheres, uint unit,
                                uint sphere, primitive_hit hit) {
    return sphere_place(sphere_axes, unit, sphere, v3_scale(hit.normal, FIELD_OF(sphere, spheres, sphere, facing)));
}

/* on_sphere: the hit_sphere_place() of one with a sphere. */
GRADUS_FN texture_point hit_texture_point(GRADUS_GLOBAL const real *triangle_texcoords, uint unit, uint triangle_count,
                                          uint primitive, primitive_hit hit, vec3 on_sphere) {
    (void)triangle_texcoords, (void)triangle_count, (void)primitive, (void)hit;
    texture_point point = point_of_sphere(on_sphere);
#if TRAIT_TRIANGLES
    const int is_triangle = !TRAIT_SPHERES || primitive < triangle_count;
    point = texture_point_select(is_triangle,
                                 point_of_triangle(HIT_UV(triangle_texcoords, unit, TRIANGLE_OF(primitive), hit),
                                                   TRIANGLE_OF(primitive), hit.u, hit.v),
                                 point);
#endif
    return point;
}

GRADUS_LIB_END
#endif
#endif
