/* Where on its own map (u, v) a point of a surface lies. */
#ifndef GRADUS_LIB_SURFACE_UV_H
#define GRADUS_LIB_SURFACE_UV_H
//! traits: TRAIT_SPHERES TRAIT_TRIANGLES
#include "kernels/lib/approximation.h"
#include "kernels/lib/texture_lookup.h"

#if HAS_TEXTURES || !defined(__OPENCL_VERSION__)
GRADUS_LIB_BEGIN

/* second, third: barycentric weights of the triangle's second and third vertex. */
GRADUS_FN texture_point point_of_triangle(GRADUS_GLOBAL const real *triangle_texcoords, uint unit, uint triangle,
                                          real second, real third) {
    const real rest = R(1) - second - third;
    texture_point point;
    point.triangle = triangle;
    point.second = second;
    point.third = third;
    point.u = rest * FIELD_OF(texcoords, triangle_texcoords, triangle, u_0) +
              second * FIELD_OF(texcoords, triangle_texcoords, triangle, u_1) +
              third * FIELD_OF(texcoords, triangle_texcoords, triangle, u_2);
    point.v = rest * FIELD_OF(texcoords, triangle_texcoords, triangle, v_0) +
              second * FIELD_OF(texcoords, triangle_texcoords, triangle, v_1) +
              third * FIELD_OF(texcoords, triangle_texcoords, triangle, v_2);
    return point;
}

/* (u, v) of a sphere where its outward normal, a unit vector, is `outward`; the rest is taken from `point`. */
GRADUS_FN texture_point point_of_sphere(GRADUS_GLOBAL const real *sphere_axes, uint unit, uint sphere, vec3 outward,
                                        texture_point point) {
    /* Component after component, axis after axis (kernels/lib/ordered.h). */
    const vec3 normal = v3_ordered(outward);
    const real x = v3_dot(normal, FIELD_V3(sphere_axes, sphere_axes, sphere, first));
    const real y = v3_dot(v3_after(normal, x), FIELD_V3(sphere_axes, sphere_axes, sphere, second));
    const real z = v3_dot(v3_after(normal, y), FIELD_V3(sphere_axes, sphere_axes, sphere, third));
    point.u = approx_turn(y, x);
    point.v = R(2) * approx_turn(r_sqrt(x * x + y * y), r_after(z, point.u));
    return point;
}

GRADUS_FN texture_point texture_point_select(int first, texture_point a, texture_point b) {
    texture_point point;
    point.u = first ? a.u : b.u;
    point.v = first ? a.v : b.v;
    point.triangle = first ? a.triangle : b.triangle;
    point.second = first ? a.second : b.second;
    point.third = first ? a.third : b.third;
    return point;
}

GRADUS_FN texture_point point_of_nothing(void) {
    texture_point point;
    point.u = R(0);
    point.v = R(0);
    point.triangle = 0u;
    point.second = R(0);
    point.third = R(0);
    return point;
}

GRADUS_LIB_END
#endif
#endif
