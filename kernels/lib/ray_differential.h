/* How a ray changes with its first direction (Igehy 1999): exact derivatives along a chain of vertices, one at a time,
 * so that no matrix of the whole chain is ever formed.
 *
 * Jakob and Marschner (2012) write the constraints of all vertices as a block tridiagonal system and solve it for the
 * step of the first vertex. With the start fixed and half vectors held, a vertex's position is a function of the first
 * direction, and its derivative a product, vertex by vertex, which a ray can carry along: two steps `s` and `t` of the
 * first direction, each with what it does to position and direction. Eliminating the blocks from the first one on is
 * the same sums; but this needs neither the chain's length nor its vertices in memory. */
#ifndef GRADUS_LIB_RAY_DIFFERENTIAL_H
#define GRADUS_LIB_RAY_DIFFERENTIAL_H
#include "kernels/lib/frame.h"
#include "kernels/lib/ordered.h"

GRADUS_LIB_BEGIN

/* World units for each unit of direction; directions are unit vectors, so changes are normal to them. */
typedef struct {
    vec3 position_s, position_t, direction_s, direction_t;
} ray_differential;

/* Of a ray from a fixed point: s and t are unit vectors and make a frame with the direction, so that an area of steps
 * is a solid angle. */
GRADUS_FN ray_differential ray_differential_begin(vec3 direction) {
    const frame f = frame_from_normal(direction);
    ray_differential d;
    d.position_s = d.position_t = v3(R(0), R(0), R(0));
    d.direction_s = f.s;
    d.direction_t = f.t;
    return d;
}

/* The change of the point where the ray meets a plane of that normal, over that distance; inverse_cosine is
 * 1 / (normal . direction). */
GRADUS_FN vec3 ray_step_at(vec3 position_step, vec3 direction_step, vec3 direction, real distance, vec3 normal,
                           real inverse_cosine) {
    const vec3 moved = v3_mad(position_step, distance, direction_step);
    return v3_mad(moved, -v3_dot(normal, moved) * inverse_cosine, direction);
}

/* The same ray at the plane that it meets there: positions change within it, directions as before. */
GRADUS_FN ray_differential ray_differential_at(ray_differential d, vec3 direction, real distance, vec3 normal,
                                               real inverse_cosine) {
    ray_differential at = d;
    at.position_s = ray_step_at(d.position_s, d.direction_s, direction, distance, normal, inverse_cosine);
    /* One after the other: kernels/lib/ordered.h. */
    at.position_t = ray_step_at(d.position_t, d.direction_t, v3_after(direction, at.position_s.x), distance, normal,
                                inverse_cosine);
    return at;
}

GRADUS_LIB_END
#endif
