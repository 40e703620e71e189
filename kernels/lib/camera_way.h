/* How far from the camera its rays begin (kernels/lib/camera_ray.h), for lengths that count from the camera itself. */
#ifndef GRADUS_LIB_CAMERA_WAY_H
#define GRADUS_LIB_CAMERA_WAY_H
//! traits: TRAIT_NEAR_CLIP
#include "kernels/lib/vector.h"
#include "kernels/shared/scene_records.h"

GRADUS_LIB_BEGIN

#if TRAIT_NEAR_CLIP
/* To the near plane, of a ray in that direction. */
GRADUS_FN real camera_way(GRADUS_GLOBAL const real *camera, uint unit, vec3 direction) {
    return FIELD_OF(camera, camera, 0, near_clip) / v3_dot(direction, FIELD_V3(camera, camera, 0, forward));
}
#define CAMERA_WAY_ARGUMENT , __global const real *camera
/* Of a ray that has `depth` edges before it, in that direction. */
#define WAY_BEFORE(depth, direction) ((depth) == 0u ? camera_way(camera, unit, direction) : R(0))
#else
#define CAMERA_WAY_ARGUMENT
#define WAY_BEFORE(depth, direction) R(0)
#endif

GRADUS_LIB_END
#endif
