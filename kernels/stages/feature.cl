/* feature: what the camera sees of vertices of one BSDF kind (rows `first` on): albedo, shading normal, depth.
 * Vertices further along a path are left alone. Runs before `scatter`, which counts the depth on. */
#include "kernels/lib/bsdf.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/stage.h"

STAGE feature(uint count, uint unit, uint first, uint capacity, uint slots, __global const real *vertex,
              __global real *feature, __global const real *camera, __global const real *materials) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = first + i;
    if (AT_UINT(vertex, depth, row) != 0u)
        return;
    const uint slot = AT_UINT(vertex, slot, row);
    const material m = material_load(materials, AT_UINT(vertex, material, row), unit);
    const vec3 away = v3_sub(AT_V3(vertex, position, row), FIELD_V3(camera, camera, 0, origin));
    const rgb albedo = PASTE(BSDF, _albedo)(m);
    const vec3 normal = VERTEX_NORMAL(row);
    SET_RGB(feature, albedo, slot, albedo);
    SET_V3(feature, normal, slot, normal);
    AT(feature, depth, slot) = r_sqrt(v3_dot(away, away));
}
