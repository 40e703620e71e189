/* Where the ray of a chain meets the primitive that the tracer named, on the very line from vertex to vertex.
 *
 * The tracer's ray starts off the surface, so its line passes the vertex at some millionths of the scene: too far for a
 * chain that is to be found to rounding, and another line than that of the derivatives. Hits are on the line through
 * the vertex itself. */
#ifndef GRADUS_LIB_CHAIN_HIT_H
#define GRADUS_LIB_CHAIN_HIT_H
//! traits: TRAIT_SHADING_NORMALS
#include "kernels/lib/normal_change.h"
#include "kernels/lib/surface_point.h"

GRADUS_LIB_BEGIN

/* Of the two points where the line meets the sphere, that nearer to where the ray from `origin`, close to the line,
 * meets it: a vertex on the sphere itself would not know. */
GRADUS_FN primitive_hit sphere_hit_on_line(vec3 center, real radius, real facing, vec3 origin, vec3 from,
                                           vec3 direction) {
    const primitive_hit of_ray = sphere_hit(center, radius, facing, origin, direction);
    const vec3 f = v3_sub(from, center);
    const real b = -v3_dot(f, direction);
    const vec3 closest = v3_mad(f, b, direction);
    const real discriminant = r_max(radius * radius - v3_dot(closest, closest), R(0));
    const real root = r_sqrt(discriminant);
    const real distance = v3_dot(v3_sub(of_ray.position, from), direction);
    const real t = b + (distance < b ? -root : root);
    const vec3 normal = v3_normalize(v3_mad(f, t, direction));
    primitive_hit hit;
    hit.u = R(0);
    hit.v = R(0);
    hit.position = v3_mad(center, r_abs(radius), normal);
    hit.normal = v3_scale(normal, facing);
    return hit;
}

/* primitive_hit_of for a ray from a vertex at `from`, which was traced from `origin`. */
GRADUS_FN primitive_hit chain_hit_of(GRADUS_GLOBAL const real *triangles, GRADUS_GLOBAL const real *spheres, uint unit,
                                     uint triangle_count, uint primitive, vec3 origin, vec3 from, vec3 direction) {
    (void)origin, (void)spheres;
    primitive_hit hit = primitive_hit_of(triangles, spheres, unit, triangle_count, primitive, from, direction);
#if TRAIT_SPHERES
    const uint sphere = SPHERE_OF(primitive);
    const primitive_hit on_sphere =
        sphere_hit_on_line(FIELD_V3(sphere, spheres, sphere, center), FIELD_OF(sphere, spheres, sphere, radius),
                           FIELD_OF(sphere, spheres, sphere, facing), origin, from, direction);
    const int is_triangle = TRAIT_TRIANGLES && primitive < triangle_count;
    hit.position = v3_select(is_triangle, hit.position, on_sphere.position);
    hit.normal = v3_select(is_triangle, hit.normal, on_sphere.normal);
#endif
    return hit;
}

/* How the shading normal `n` at a hit changes; n is turned from the primitive's own side where `n . own` < 0. */
GRADUS_FN normal_change normal_change_of(GRADUS_GLOBAL const real *triangles,
                                         GRADUS_GLOBAL const real *triangle_normals, GRADUS_GLOBAL const real *spheres,
                                         uint unit, uint triangle_count, uint primitive, primitive_hit hit, vec3 n,
                                         vec3 geometric) {
    (void)triangles, (void)triangle_normals, (void)spheres, (void)unit, (void)triangle_count, (void)primitive;
    (void)hit, (void)geometric;
    normal_change change = normal_change_flat(n);
    /* surface_point_at turns both normals alike. */
    const real turn = r_copysign1(v3_dot(geometric, hit.normal));
    (void)turn;
#if TRAIT_SHADING_NORMALS
    const uint smooth = TRIANGLE_OF(primitive);
    const scene_triangle triangle = scene_triangle_of(triangles, unit, smooth);
    const vertex_normals normals = vertex_normals_of(triangle_normals, unit, smooth, hit);
    const normal_change of_triangle =
        normal_change_triangle(triangle.e1, triangle.e2, normals.n0, normals.n1, normals.n2, hit.u, hit.v, turn);
    const int is_smooth = !TRAIT_SPHERES || primitive < triangle_count;
    const real keep = is_smooth ? R(1) : R(0);
    change.u = v3_scale(of_triangle.u, keep);
    change.v = v3_scale(of_triangle.v, keep);
    change.along_u = of_triangle.along_u;
    change.along_v = of_triangle.along_v;
#endif
#if TRAIT_SPHERES
    const uint sphere = SPHERE_OF(primitive);
    const real curvature =
        turn * FIELD_OF(sphere, spheres, sphere, facing) / r_abs(FIELD_OF(sphere, spheres, sphere, radius));
    change.curvature = TRAIT_TRIANGLES && primitive < triangle_count ? R(0) : curvature;
#endif
    return change;
}

GRADUS_LIB_END
#endif
