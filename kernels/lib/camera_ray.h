/* Rays of the camera. */
#ifndef GRADUS_LIB_CAMERA_RAY_H
#define GRADUS_LIB_CAMERA_RAY_H
//! traits: TRAIT_ORTHOGRAPHIC TRAIT_THIN_LENS TRAIT_NEAR_CLIP
#include "kernels/lib/camera_way.h"
#include "kernels/lib/vector.h"
#include "kernels/lib/warp.h"
#include "kernels/shared/scene_records.h"

GRADUS_LIB_BEGIN

/* Where a ray of the camera begins, and its unit direction, in the world frame. */
typedef struct {
    vec3 origin, direction;
    GRADUS_NOT_IN_REGISTERS
} camera_sight;

/* The ray through a point of the full film, in pixels from its top left, and through a point of the lens, by two
 * numbers in [0, 1). Rays of a thin lens meet in the plane of focus (Cook et al. 1984); those of an orthographic camera
 * are parallel. They begin where the camera begins to see, at its near plane, if anything is nearer. */
GRADUS_FN camera_sight camera_sight_through(GRADUS_GLOBAL const real *camera, uint unit, real film_x, real film_y,
                                            real lens_1, real lens_2) {
    camera_sight sight;
    sight.origin = FIELD_V3(camera, camera, 0, origin);
    vec3 towards = v3_mad(v3_mad(FIELD_V3(camera, camera, 0, corner), film_x, FIELD_V3(camera, camera, 0, right)),
                          film_y, FIELD_V3(camera, camera, 0, down));
    (void)lens_1, (void)lens_2;
#if TRAIT_ORTHOGRAPHIC
    sight.origin = v3_mad(v3_mad(sight.origin, film_x, FIELD_V3(camera, camera, 0, step_right)), film_y,
                          FIELD_V3(camera, camera, 0, step_down));
#endif
#if TRAIT_THIN_LENS
    const point2 place = warp_uniform_disk(lens_1, lens_2);
    const vec3 lens = v3_mad(v3_scale(FIELD_V3(camera, camera, 0, lens_left), place.x), place.y,
                             FIELD_V3(camera, camera, 0, lens_up));
    sight.origin = v3_add(sight.origin, lens);
    towards = v3_mad(towards, -FIELD_OF(camera, camera, 0, inverse_focus), lens);
#endif
    sight.direction = v3_normalize(towards);
#if TRAIT_NEAR_CLIP
    sight.origin = v3_mad(sight.origin, camera_way(camera, unit, sight.direction), sight.direction);
#endif
    return sight;
}

/* Something made of what every camera's record is read for, for HAS_ROW (kernels/shared/stage.h). */
GRADUS_FN uint camera_bits(GRADUS_GLOBAL const real *camera, uint unit) {
    uint bits = 0u;
#define CAMERA_BITS(field)                                                                                             \
    bits |= as_uint((float)FIELD_OF(camera, camera, 0, field##_x)) |                                                   \
            as_uint((float)FIELD_OF(camera, camera, 0, field##_y)) |                                                   \
            as_uint((float)FIELD_OF(camera, camera, 0, field##_z));
    CAMERA_BITS(origin)
    CAMERA_BITS(corner)
    CAMERA_BITS(right)
    CAMERA_BITS(down)
#if TRAIT_ORTHOGRAPHIC
    CAMERA_BITS(step_right)
    CAMERA_BITS(step_down)
#endif
#if TRAIT_THIN_LENS
    CAMERA_BITS(lens_left)
    CAMERA_BITS(lens_up)
#endif
#if TRAIT_NEAR_CLIP
    CAMERA_BITS(forward)
#endif
#undef CAMERA_BITS
    return bits;
}

GRADUS_LIB_END
#endif
