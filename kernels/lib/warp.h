/* Maps from the unit square to other domains, and their densities. u, u1, u2 are uniform in [0, 1). */
#ifndef GRADUS_LIB_WARP_H
#define GRADUS_LIB_WARP_H
#include "kernels/lib/approximation.h"
#include "kernels/lib/vector.h"

GRADUS_LIB_BEGIN

typedef struct {
    real x, y;
    GRADUS_NOT_IN_REGISTERS
} point2;

/* Uniform on the unit disk; density 1/pi by area. */
GRADUS_FN point2 warp_uniform_disk(real u1, real u2) {
    const real radius = r_sqrt(u1);
    const sine_cosine turn = approx_sine_cosine_2pi(u2);
    point2 p;
    p.x = radius * turn.cosine;
    p.y = radius * turn.sine;
    return p;
}

/* Unit vector around +z with density cos(theta)/pi by solid angle; z > 0 always. */
GRADUS_FN vec3 warp_cosine_hemisphere(real u1, real u2) {
    const point2 p = warp_uniform_disk(u1, u2);
    return v3(p.x, p.y, r_sqrt(R(1) - u1));
}

/* Density of warp_cosine_hemisphere by solid angle; 0 below the horizon. */
GRADUS_FN real warp_cosine_hemisphere_pdf(real cosine) { return r_max(cosine, R(0)) * GRADUS_INV_PI; }

/* Unit vector with density 1/(4 pi) by solid angle. */
GRADUS_FN vec3 warp_uniform_sphere(real u1, real u2) {
    const real radius = R(2) * r_sqrt(u1 * (R(1) - u1));
    const sine_cosine turn = approx_sine_cosine_2pi(u2);
    return v3(radius * turn.cosine, radius * turn.sine, R(1) - R(2) * u1);
}

GRADUS_FN real warp_uniform_sphere_pdf(void) { return R(0.25) * GRADUS_INV_PI; }

/* 1 - cos(angle) from sin^2(angle), angle in [0, pi/2], without cancellation: exact to rounding for tiny angles. */
GRADUS_FN real warp_one_minus_cosine(real sine_squared) {
    return sine_squared / (R(1) + r_sqrt(r_max(R(1) - sine_squared, R(0))));
}

/* Uniform by solid angle in the cone around +z whose half angle has the given 1 - cosine, in (0, 2]. */
GRADUS_FN vec3 warp_uniform_cone(real one_minus_cosine, real u1, real u2) {
    const real depth = u1 * one_minus_cosine;
    const real radius = r_sqrt(depth * (R(2) - depth));
    const sine_cosine turn = approx_sine_cosine_2pi(u2);
    return v3(radius * turn.cosine, radius * turn.sine, R(1) - depth);
}

/* Density of warp_uniform_cone by solid angle, inside the cone. */
GRADUS_FN real warp_uniform_cone_pdf(real one_minus_cosine) { return R(0.5) * GRADUS_INV_PI / one_minus_cosine; }

/* Barycentric coordinates (x, y), uniform by area over the triangle; x, y >= 0 and x + y <= 1. */
GRADUS_FN point2 warp_uniform_triangle(real u1, real u2) {
    const real root = r_sqrt(u1);
    point2 p;
    p.x = R(1) - root;
    p.y = u2 * root;
    return p;
}

GRADUS_LIB_END
#endif
