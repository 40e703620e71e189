/* far_clip: rays of the camera, rows [0, count), that met something beyond its far plane have met nothing. Later
 * rays of paths stay as they are. */
//! traits: TRAIT_NEAR_CLIP
#include "kernels/lib/scene_hit.h"
#include "kernels/shared/stage.h"

STAGE far_clip(uint count, uint unit, uint capacity, __global real *ray, __global const real *path,
               __global const real *triangles, __global const real *spheres, __global const real *camera,
               uint triangle_count) {
    const size_t row = work_item();
    if (row >= count)
        return;
    const uint primitive = AT_UINT(ray, primitive, row);
    const vec3 origin = AT_V3(ray, origin, row), direction = AT_V3(ray, direction, row);
    const int is_hit = primitive < ray_first_special;
    const primitive_hit hit = primitive_hit_of(triangles, spheres, unit, triangle_count,
                                               is_hit ? primitive : 0u INSTANCE_IN(ray, ray, row), origin, direction);
    real depth = v3_dot(v3_sub(hit.position, origin), FIELD_V3(camera, camera, 0, forward));
#if TRAIT_NEAR_CLIP
    depth += FIELD_OF(camera, camera, 0, near_clip);
#endif
    const int is_beyond = is_hit & (AT_UINT(path, depth, row) == 0u) & (depth > FIELD_OF(camera, camera, 0, far_clip));
    AT_UINT(ray, primitive, row) = is_beyond ? ray_escaped : primitive;
}
