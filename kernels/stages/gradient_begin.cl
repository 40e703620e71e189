/* gradient_begin: begins one base path a row from what the camera saw: its first ray, already traced. Its sums are
 * begun where its first vertex is lit (`weigh`), or here where there is none. */
//! traits: TRAIT_CAMERA_ORIGINS TRAIT_INSTANCES
#include "kernels/lib/begin_path.h"

STAGE gradient_begin(uint count, uint unit, uint capacity, uint slots, __global real *ray, __global real *path,
                     __global real *radiance, __global real *direct, __global real *prefix, __global real *difference,
                     __global const real *primary, __global const real *camera, uint first_row, uint first_slot,
                     uint primary_shift) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = first_row + i;
    const size_t slot = (size_t)first_slot + i, seen = slot + primary_shift;
#if TRAIT_CAMERA_ORIGINS
    const vec3 origin = AT_V3(primary, origin, seen);
#else
    const vec3 origin = FIELD_V3(camera, camera, 0, origin);
#endif
    const vec3 direction = AT_V3(primary, direction, seen);
    const uint primitive = AT_UINT(primary, primitive, seen);
    SET_V3(ray, origin, row, origin);
    SET_V3(ray, direction, row, direction);
    AT_UINT(ray, primitive, row) = primitive;
#if TRAIT_INSTANCES
    AT_UINT(ray, instance, row) = AT_UINT(primary, instance, seen);
#endif
    BEGIN_PATH(row, slot, AT_UINT(primary, key_0, seen), AT_UINT(primary, key_1, seen))
    SET_RGB(radiance, value, slot, rgb_gray(R(0)));
    SET_RGB_IN(direct, radiance, value, slot, rgb_gray(R(0)));
    SET_RGB(prefix, value, slot, rgb_gray(R(0)));
    SET_RGB(prefix, throughput, slot, rgb_gray(R(0)));
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * slots + slot;
        SET_RGB(difference, value, at, rgb_gray(R(0)));
        AT(difference, ratio, at) = shift_absent;
    }
}
