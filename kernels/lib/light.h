/* Light sampling: choosing a point of a light as seen from a place, and the density with which that is done. Densities
 * are in solid angle at the place, and do not include the probability of choosing the light. */
#ifndef GRADUS_LIB_LIGHT_H
#define GRADUS_LIB_LIGHT_H
#include "kernels/lib/frame.h"
#include "kernels/lib/ordered.h"
#include "kernels/lib/ray_start.h"
#include "kernels/lib/vector.h"
#include "kernels/lib/warp.h"
#include "kernels/shared/scene_records.h"

GRADUS_LIB_BEGIN

typedef struct {
    vec3 direction;  /* unit vector towards the light point */
    vec3 connection; /* from the place to the light point; for lights at infinity longer than the scene */
    vec3 normal;     /* at the light point; zero for lights without a surface */
    rgb value;       /* radiance over density; for Dirac lights what arrives */
    real pdf;        /* solid angle; 0 for Dirac lights, which BSDF sampling cannot meet */
} light_choice;

/* Density in solid angle of a uniform choice on a surface, from the area's inverse, the squared distance and the
 * cosine at the light; 0 from behind. */
GRADUS_FN real light_area_pdf(real inverse_area, real distance_squared, real cosine) {
    return cosine > R(0) ? inverse_area * distance_squared / cosine : R(0);
}

/* 1 - cos of the cone that a sphere fills, without cancellation for small ones. */
GRADUS_FN real light_sphere_cone(real radius, real distance_squared) {
    const real sine_squared = r_min(radius * radius / distance_squared, R(1));
    return sine_squared / (R(1) + r_sqrt(R(1) - sine_squared));
}

/* Density with which light_from_sphere finds a point. From outside a sphere that faces out, uniform in its cone; else
 * uniform in area. */
GRADUS_FN real light_sphere_pdf(real radius, real facing, real inverse_area, real center_distance_squared,
                                real distance_squared, real cosine) {
    const int cone = facing > R(0) && center_distance_squared > radius * radius * R(1.0001);
    const real cone_pdf = R(0.5) * GRADUS_INV_PI / r_max(light_sphere_cone(radius, center_distance_squared), R(1e-30));
    const real area_pdf = light_area_pdf(inverse_area, distance_squared, cosine);
    return cosine > R(0) ? (cone ? cone_pdf : area_pdf) : R(0);
}

GRADUS_FN light_choice light_from_surface(rgb radiance, real pdf, vec3 place, vec3 point, vec3 normal) {
    light_choice s;
    s.connection = v3_sub(point, place);
    const real distance_squared = r_max(v3_dot(s.connection, s.connection), R(1e-36));
    s.direction = v3_scale(s.connection, R(1) / r_sqrt(distance_squared));
    s.normal = normal;
    s.pdf = pdf;
    s.value = rgb_scale(radiance, pdf > R(0) ? R(1) / pdf : R(0));
    return s;
}

GRADUS_FN light_choice light_from_triangle(rgb radiance, vec3 p0, vec3 e1, vec3 e2, vec3 place, real u1, real u2) {
    const point2 b = warp_uniform_triangle(u1, u2);
    const vec3 parallelogram = v3_cross(e1, e2);
    const real inverse = R(1) / r_sqrt(v3_dot(parallelogram, parallelogram));
    const vec3 normal = v3_scale(parallelogram, inverse);
    /* The connection is normalised too, after the normal (kernels/lib/ordered.h). */
    const vec3 point = v3_after(v3_mad(v3_mad(p0, b.x, e1), b.y, e2), normal.x);
    const vec3 connection = v3_sub(point, place);
    const real distance_squared = r_max(v3_dot(connection, connection), R(1e-36));
    const real cosine = -v3_dot(normal, connection) / r_sqrt(distance_squared);
    return light_from_surface(radiance, light_area_pdf(R(2) * inverse, distance_squared, cosine), place, point, normal);
}

GRADUS_FN light_choice light_from_sphere(rgb radiance, vec3 center, real radius, real facing, real inverse_area,
                                         vec3 place, real u1, real u2) {
    const vec3 to_center = v3_sub(center, place);
    const real center_distance_squared = r_max(v3_dot(to_center, to_center), R(1e-36));
    const real center_distance = r_sqrt(center_distance_squared);
    const int cone = facing > R(0) && center_distance_squared > radius * radius * R(1.0001);
    /* In the cone: the direction, then the sphere's normal at the nearer of the two points it meets, in the frame
     * of the axis. With sin a at the place, the distance is t = d cos a - h, h = sqrt(r^2 - d^2 sin^2 a). Along the
     * axis the normal is t cos a - d = -d sin^2 a - h cos a, in which nothing cancels where the sphere is far away. */
    const vec3 ray_local = warp_uniform_cone(light_sphere_cone(radius, center_distance_squared), u1, u2);
    const real sine_squared = ray_local.x * ray_local.x + ray_local.y * ray_local.y;
    const real half_chord = r_sqrt(r_max(radius * radius - center_distance_squared * sine_squared, R(0)));
    const real distance = center_distance * ray_local.z - half_chord;
    const frame axis = frame_from_normal(v3_scale(to_center, R(1) / center_distance));
    const vec3 cone_normal =
        v3_normalize(frame_to_world(axis, v3(distance * ray_local.x, distance * ray_local.y,
                                             -center_distance * sine_squared - half_chord * ray_local.z)));
    const vec3 area_normal = warp_uniform_sphere(u1, u2);
    const vec3 outward = v3(cone ? cone_normal.x : area_normal.x, cone ? cone_normal.y : area_normal.y,
                            cone ? cone_normal.z : area_normal.z);
    const vec3 point = v3_mad(center, radius, outward);
    const vec3 normal = v3_scale(outward, facing);
    const vec3 connection = v3_sub(point, place);
    const real distance_squared = r_max(v3_dot(connection, connection), R(1e-36));
    const real cosine = -v3_dot(normal, connection) / r_sqrt(distance_squared);
    const real pdf = light_sphere_pdf(radius, facing, inverse_area, center_distance_squared, distance_squared, cosine);
    return light_from_surface(radiance, pdf, place, point, normal);
}

/* A point: its intensity over the squared distance arrives. It has no surface; its normal says to where connections end
 * before it, should it lie in one. */
GRADUS_FN light_choice light_from_point(rgb intensity, vec3 point, vec3 place) {
    light_choice s;
    s.connection = v3_sub(point, place);
    const real inverse_squared = R(1) / r_max(v3_dot(s.connection, s.connection), R(1e-36));
    s.direction = v3_scale(s.connection, r_sqrt(inverse_squared));
    s.normal = v3_neg(s.direction);
    s.value = rgb_scale(intensity, inverse_squared);
    s.pdf = R(0);
    return s;
}

/* How much of a spot's intensity goes into a direction from it: all within the beam, none beyond the cutoff, in between
 * linear in the angle from the axis. cutoff: that angle in turns; steepness: one over what it lies beyond the beam. */
GRADUS_FN real light_spot_falloff(vec3 axis, vec3 direction, real cutoff, real steepness) {
    const vec3 across = v3_cross(axis, direction);
    const real angle = approx_turn(r_sqrt(v3_dot(across, across)), v3_dot(axis, direction));
    return r_clamp((cutoff - angle) * steepness, R(0), R(1));
}

/* A point that shines along its axis. */
GRADUS_FN light_choice light_from_spot(rgb intensity, vec3 point, vec3 axis, real cutoff, real steepness, vec3 place) {
    light_choice s = light_from_point(intensity, point, place);
    s.value = rgb_scale(s.value, light_spot_falloff(axis, v3_neg(s.direction), cutoff, steepness));
    return s;
}

/* Parallel light, which comes from the direction `towards`. `beyond`: longer than the scene. */
GRADUS_FN light_choice light_from_direction(rgb irradiance, vec3 towards, real beyond) {
    light_choice s;
    s.direction = towards;
    s.connection = v3_scale(towards, beyond);
    s.normal = v3(R(0), R(0), R(0));
    s.value = irradiance;
    s.pdf = R(0);
    return s;
}

/* The constant environment, uniform over the sphere. */
GRADUS_FN light_choice light_from_constant(rgb radiance, real beyond, real u1, real u2) {
    light_choice s;
    s.direction = warp_uniform_sphere(u1, u2);
    s.connection = v3_scale(s.direction, beyond);
    s.normal = v3(R(0), R(0), R(0));
    s.value = rgb_scale(radiance, R(4) * GRADUS_PI);
    s.pdf = R(0.25) * GRADUS_INV_PI;
    return s;
}

GRADUS_FN light_choice light_choice_select(int first, light_choice a, light_choice b) {
    light_choice s;
    s.direction = v3_select(first, a.direction, b.direction);
    s.connection = v3_select(first, a.connection, b.connection);
    s.normal = v3_select(first, a.normal, b.normal);
    s.value = rgb_select(first, a.value, b.value);
    s.pdf = first ? a.pdf : b.pdf;
    return s;
}

GRADUS_LIB_END
#endif
