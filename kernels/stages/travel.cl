/* travel: how far camera paths came that go on from a surface which is too smooth to gather at: paths at places `first`
 * on of `index`. Leaves it in `travelled`, by slot. */
#include "kernels/lib/camera_way.h"
#include "kernels/lib/scene_hit.h"
#include "kernels/shared/stage.h"

STAGE travel(uint count, uint unit, uint first, uint capacity, __global const uint *index,
             __global const real *path_old, __global const real *ray_old, __global real *travelled,
             __global const real *triangles, __global const real *spheres, uint triangle_count CAMERA_WAY_ARGUMENT) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const int old = AT_INDEX(first + i);
    const vec3 origin = AT_V3_IN(ray_old, ray, origin, old), direction = AT_V3_IN(ray_old, ray, direction, old);
    const uint depth = AT_UINT_IN(path_old, path, depth, old), slot = AT_UINT_IN(path_old, path, slot, old);
    const primitive_hit hit =
        primitive_hit_of(triangles, spheres, unit, triangle_count,
                         AT_UINT_IN(ray_old, ray, primitive, old) INSTANCE_IN(ray_old, ray, old), origin, direction);
    const vec3 step = v3_sub(hit.position, origin);
    const real before = travelled[slot];
    travelled[slot] = r_sqrt(v3_dot(step, step)) + (depth > 0u ? before : WAY_BEFORE(0u, direction));
}
