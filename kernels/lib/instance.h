/* Where an instance of a group of shapes stands. Vertices of the group are in its own frame; what kernels read of them
 * is taken to the world at once, so that all that follows is there. */
#ifndef GRADUS_LIB_INSTANCE_H
#define GRADUS_LIB_INSTANCE_H
//! traits: TRAIT_INSTANCES
#include "kernels/lib/vector.h"
#include "kernels/shared/scene_records.h"

/* An argument that there is with instances alone: the record of one. */
#if TRAIT_INSTANCES
#define INSTANCE_PARAMETER , uint instance
#define INSTANCE_ARGUMENT , instance
#else
#define INSTANCE_PARAMETER
#define INSTANCE_ARGUMENT
#endif

GRADUS_LIB_BEGIN

/* An affine map from the frame of a group to the world. */
typedef struct {
    vec3 x, y, z; /* where the axes go */
    vec3 origin;  /* where the origin does */
    real facing;  /* -1 where it mirrors, else 1 */
    GRADUS_NOT_IN_REGISTERS
} instance_map;

/* Records of instances lie behind the vertices, in `triangles`; their numbers count from where that begins. */
#define INSTANCE_FIELD(array, number, field) FIELD_OF(instance, array, number, field)

GRADUS_FN instance_map instance_map_of(GRADUS_GLOBAL const real *triangles, uint unit, uint instance) {
    instance_map map;
    map.x = FIELD_V3(instance, triangles, instance, x);
    map.y = FIELD_V3(instance, triangles, instance, y);
    map.z = FIELD_V3(instance, triangles, instance, z);
    map.origin = FIELD_V3(instance, triangles, instance, origin);
    map.facing = INSTANCE_FIELD(triangles, instance, facing);
    return map;
}

GRADUS_FN vec3 placed_vector(instance_map map, vec3 v) {
    return v3_mad(v3_mad(v3_scale(map.x, v.x), v.y, map.y), v.z, map.z);
}

GRADUS_FN vec3 placed_point(instance_map map, vec3 p) { return v3_add(map.origin, placed_vector(map, p)); }

/* A normal, of another length: by the cofactors, which are the inverse transpose times the determinant, and by the
 * determinant's sign, so that a mirror turns no front. */
GRADUS_FN vec3 placed_normal(instance_map map, vec3 n) {
    const vec3 of_x = v3_cross(map.y, map.z), of_y = v3_cross(map.z, map.x), of_z = v3_cross(map.x, map.y);
    return v3_scale(v3_mad(v3_mad(v3_scale(of_x, n.x), n.y, of_y), n.z, of_z), map.facing);
}

/* How far the tracer's and the kernels' rounding in taking rays to the group's frame, and points back, may move a point
 * along the unit vector `normal`. */
GRADUS_FN real instance_rounding(GRADUS_GLOBAL const real *triangles, uint unit, uint instance, vec3 normal) {
    const vec3 most = FIELD_V3(instance, triangles, instance, rounding);
    return r_abs(normal.x * most.x) + r_abs(normal.y * most.y) + r_abs(normal.z * most.z);
}

/* A record that may be read in either case. */
GRADUS_FN uint present_instance(int is_hit, uint instance) { return is_hit ? instance : 0u; }

GRADUS_LIB_END
#endif
