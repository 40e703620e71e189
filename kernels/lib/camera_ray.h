/* Rays of the camera. */
#ifndef GRADUS_LIB_CAMERA_RAY_H
#define GRADUS_LIB_CAMERA_RAY_H
#include "kernels/lib/vector.h"
#include "kernels/shared/scene_records.h"

GRADUS_LIB_BEGIN

/* The unit direction, world frame, through a point of the full film, in pixels from its top left. */
GRADUS_FN vec3 camera_direction(GRADUS_GLOBAL const real *camera, uint unit, real film_x, real film_y) {
    return v3_normalize(v3_mad(v3_mad(FIELD_V3(camera, camera, 0, corner), film_x, FIELD_V3(camera, camera, 0, right)),
                               film_y, FIELD_V3(camera, camera, 0, down)));
}

GRADUS_LIB_END
#endif
