/* Where on its own map (u, v) a point of a surface lies, and between which vertices of a mesh. */
#ifndef GRADUS_LIB_SURFACE_UV_H
#define GRADUS_LIB_SURFACE_UV_H
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

GRADUS_LIB_END
#endif
#endif
