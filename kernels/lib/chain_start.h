/* Where a chain of a walk starts: at a point, whose rays change direction, or at infinity, where all rays of a light
 * are parallel and change place (kernels/shared/walk_tables.h). Of the latter a solid angle at the start is an area
 * across the rays, in which their density is uniform; all else of a walk is the same. */
#ifndef GRADUS_LIB_CHAIN_START_H
#define GRADUS_LIB_CHAIN_START_H
//! traits: TRAIT_LIGHT_DIRECTIONAL TRAIT_LIGHT_CONSTANT TRAIT_LIGHT_ENVIRONMENT
#include "kernels/lib/ray_differential.h"
#include "kernels/lib/ray_start.h"
#include "kernels/shared/walk_tables.h"

#define LIGHTS_AT_INFINITY (TRAIT_LIGHT_DIRECTIONAL | TRAIT_LIGHT_CONSTANT | TRAIT_LIGHT_ENVIRONMENT)

GRADUS_LIB_BEGIN

typedef struct {
    vec3 position, normal;
    real offset;
    GRADUS_NOT_IN_REGISTERS
} chain_start;

/* Whether its rays are parallel. */
GRADUS_FN int chain_start_is_far(real offset) { return LIGHTS_AT_INFINITY && offset < R(0); }

typedef struct {
    vec3 origin;    /* for the tracer */
    vec3 from;      /* on the line through the aim, before it, for hits on that line */
    vec3 direction; /* unit vector */
    ray_differential beam;
    GRADUS_NOT_IN_REGISTERS
} chain_ray;

/* The ray through `aim`. `near`: a length that is small beside the scene; hits on lines from the scene's bounds would
 * be off by what rounding does over that length. */
GRADUS_FN chain_ray chain_ray_through(chain_start start, vec3 aim, real near) {
    const vec3 way = v3_sub(aim, start.position);
    chain_ray ray;
    ray.direction = v3_scale(way, R(1) / r_sqrt(r_max(v3_dot(way, way), R(1e-30))));
    ray.from = start.position;
#if !LIGHTS_AT_INFINITY
    (void)near;
    ray.origin = ray_origin(start.position, start.normal, start.offset, ray.direction);
    ray.beam = ray_differential_begin(ray.direction);
#else
    const int is_far = chain_start_is_far(start.offset);
    ray.direction = v3_select(is_far, start.normal, ray.direction);
    const real reach = v3_dot(way, ray.direction);
    ray.from = v3_select(is_far, v3_mad(aim, -near, ray.direction), ray.from);
    ray.origin = v3_select(is_far, v3_mad(aim, -reach, ray.direction),
                           ray_origin(start.position, start.normal, start.offset, ray.direction));
    ray.beam = ray_differential_begin(ray.direction);
    const vec3 s = ray.beam.direction_s, t = ray.beam.direction_t, none = v3(R(0), R(0), R(0));
    ray.beam.position_s = v3_select(is_far, s, none);
    ray.beam.position_t = v3_select(is_far, t, none);
    ray.beam.direction_s = v3_select(is_far, none, s);
    ray.beam.direction_t = v3_select(is_far, none, t);
#endif
    return ray;
}

GRADUS_LIB_END
#endif
