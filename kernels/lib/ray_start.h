/* Where rays begin and end at surfaces: off them, by no more than what rounding may hide, so that panes of a few units
 * in the last place still have an inside.
 *
 * With u = 2^-24, half a unit in the last place: a point p computed on a surface of normal n is off it by at most
 * 2 u (|n_x p_x| + |n_y p_y| + |n_z p_z|), and a ray's origin that is stored once more by half of that. Then there is
 * what the tracer itself errs by in meeting the surface, which goes with the size of the primitive and the angles of a
 * triangle (`offset` of its record, runtime/scene/scene_tables.cpp), and for a ray from far away with its length. */
#ifndef GRADUS_LIB_RAY_START_H
#define GRADUS_LIB_RAY_START_H
#include "kernels/lib/vector.h"

GRADUS_LIB_BEGIN

/* 4 u, a third more than the bound above. */
#define GRADUS_ROUNDING R(2.384185791015625e-7)

/* How far rounding of a vector of that size moves a point along the unit vector `normal`. */
GRADUS_FN real rounding_along(vec3 normal, vec3 size) {
    return GRADUS_ROUNDING * (r_abs(normal.x * size.x) + r_abs(normal.y * size.y) + r_abs(normal.z * size.z));
}

/* What is left of two points that are one, where rays have been traced to them: the tracer works in float whatever the
 * precision of kernels, from origins off the surfaces. Two units in the last place of the largest coordinate. */
GRADUS_FN real traced_rounding(vec3 a, vec3 b) { return R(2) * GRADUS_ROUNDING * r_max(v3_largest(a), v3_largest(b)); }

/* How far a ray starts off a primitive's point: `of_primitive` is its record's. */
GRADUS_FN real offset_at(vec3 position, vec3 geometric, real of_primitive) {
    return of_primitive + rounding_along(geometric, position);
}

/* Where a ray starts from a surface in a direction: moved off it by `offset` along the geometric normal. */
GRADUS_FN vec3 ray_origin(vec3 position, vec3 geometric, real offset, vec3 direction) {
    return v3_mad(position, offset * r_copysign1(v3_dot(geometric, direction)), geometric);
}

/* The end, or the whole, of a connection `way` long to a surface, moved off that towards where `facing`, its unit
 * normal, points. Where the tracer meets a sphere is off by some six roundings of the way to its center, which is why
 * the way's own are taken twice. */
GRADUS_FN vec3 connection_before(vec3 end, vec3 facing, real offset, vec3 way) {
    return v3_mad(end, offset + R(2) * rounding_along(facing, way), facing);
}

/* Where such a connection ends: on the side that it comes from. */
GRADUS_FN vec3 connection_end(vec3 position, vec3 geometric, real offset, vec3 way) {
    const real side = r_copysign1(v3_dot(geometric, v3_neg(way)));
    return connection_before(position, v3_scale(geometric, side), offset, way);
}

GRADUS_LIB_END
#endif
