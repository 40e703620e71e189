/* Where on its own map (u, v) a point of a surface lies, and between which vertices of a mesh. */
#ifndef GRADUS_LIB_SURFACE_UV_H
#define GRADUS_LIB_SURFACE_UV_H
#include "kernels/lib/approximation.h"
#include "kernels/lib/scene_triangle.h"
#include "kernels/lib/texture_lookup.h"

#if HAS_TEXTURES || !defined(__OPENCL_VERSION__)
GRADUS_LIB_BEGIN

typedef struct {
    real u_0, v_0, u_1, v_1, u_2, v_2;
    uint corner_0, corner_1, corner_2; /* with TRAIT_INDEXED */
} triangle_uv;

#if TRAIT_INDEXED
GRADUS_FN triangle_uv uv_of_corners(GRADUS_GLOBAL const real *vertices, uint unit, uint corner_0, uint corner_1,
                                    uint corner_2) {
    triangle_uv uv;
    uv.u_0 = OF_VERTEX(vertices, corner_0, vertex_u);
    uv.v_0 = OF_VERTEX(vertices, corner_0, vertex_v);
    uv.u_1 = OF_VERTEX(vertices, corner_1, vertex_u);
    uv.v_1 = OF_VERTEX(vertices, corner_1, vertex_v);
    uv.u_2 = OF_VERTEX(vertices, corner_2, vertex_u);
    uv.v_2 = OF_VERTEX(vertices, corner_2, vertex_v);
    uv.corner_0 = corner_0;
    uv.corner_1 = corner_1;
    uv.corner_2 = corner_2;
    return uv;
}
/* Of the triangle that was hit, whose number is `triangle`. */
#define HIT_UV(triangle_texcoords, unit, triangle, hit)                                                                \
    uv_of_corners(triangle_texcoords, unit, (hit).corner_0, (hit).corner_1, (hit).corner_2)
#else
#define HIT_UV(triangle_texcoords, unit, triangle, hit) triangle_uv_of(triangle_texcoords, unit, triangle)
#endif

GRADUS_FN triangle_uv triangle_uv_of(GRADUS_GLOBAL const real *triangle_texcoords, uint unit, uint triangle) {
#if TRAIT_INDEXED
    return uv_of_corners(triangle_texcoords, unit, CORNER_OF(triangle_texcoords, triangle, 0),
                         CORNER_OF(triangle_texcoords, triangle, 1), CORNER_OF(triangle_texcoords, triangle, 2));
#else
    triangle_uv uv;
    uv.u_0 = FIELD_OF(texcoords, triangle_texcoords, triangle, u_0);
    uv.v_0 = FIELD_OF(texcoords, triangle_texcoords, triangle, v_0);
    uv.u_1 = FIELD_OF(texcoords, triangle_texcoords, triangle, u_1);
    uv.v_1 = FIELD_OF(texcoords, triangle_texcoords, triangle, v_1);
    uv.u_2 = FIELD_OF(texcoords, triangle_texcoords, triangle, u_2);
    uv.v_2 = FIELD_OF(texcoords, triangle_texcoords, triangle, v_2);
    uv.corner_0 = uv.corner_1 = uv.corner_2 = 0u;
    return uv;
#endif
}

/* second, third: barycentric weights of the triangle's second and third vertex. */
GRADUS_FN texture_point point_of_triangle(triangle_uv uv, uint triangle, real second, real third) {
    const real rest = R(1) - second - third;
    texture_point point;
    point.triangle = triangle;
    point.second = second;
    point.third = third;
#if TRAIT_INDEXED || !defined(__OPENCL_VERSION__)
    point.corner_0 = uv.corner_0;
    point.corner_1 = uv.corner_1;
    point.corner_2 = uv.corner_2;
#endif
    point.u = rest * uv.u_0 + second * uv.u_1 + third * uv.u_2;
    point.v = rest * uv.v_0 + second * uv.v_1 + third * uv.v_2;
    return point;
}

/* The place on a unit sphere, in a sphere's own axes, of its outward normal, a unit vector in world space. */
GRADUS_FN vec3 sphere_place(GRADUS_GLOBAL const real *sphere_axes, uint unit, uint sphere, vec3 outward) {
    /* Component after component, axis after axis (kernels/lib/ordered.h). */
    const vec3 normal = v3_ordered(outward);
    const real x = v3_dot(normal, FIELD_V3(sphere_axes, sphere_axes, sphere, first));
    const real y = v3_dot(v3_after(normal, x), FIELD_V3(sphere_axes, sphere_axes, sphere, second));
    const real z = v3_dot(v3_after(normal, y), FIELD_V3(sphere_axes, sphere_axes, sphere, third));
    return v3(x, y, z);
}

GRADUS_FN texture_point point_of_sphere(vec3 place) {
    texture_point point;
    point.u = approx_turn(place.y, place.x);
    point.v = R(2) * approx_turn(r_sqrt(place.x * place.x + place.y * place.y), r_after(place.z, point.u));
    point.triangle = 0u;
    point.second = R(0);
    point.third = R(0);
#if TRAIT_INDEXED || !defined(__OPENCL_VERSION__)
    point.corner_0 = point.corner_1 = point.corner_2 = 0u;
#endif
    return point;
}

GRADUS_FN texture_point texture_point_select(int first, texture_point a, texture_point b) {
    texture_point point;
    point.u = first ? a.u : b.u;
    point.v = first ? a.v : b.v;
    point.triangle = first ? a.triangle : b.triangle;
    point.second = first ? a.second : b.second;
    point.third = first ? a.third : b.third;
#if TRAIT_INDEXED || !defined(__OPENCL_VERSION__)
    point.corner_0 = first ? a.corner_0 : b.corner_0;
    point.corner_1 = first ? a.corner_1 : b.corner_1;
    point.corner_2 = first ? a.corner_2 : b.corner_2;
#endif
    return point;
}

GRADUS_LIB_END
#endif
#endif
