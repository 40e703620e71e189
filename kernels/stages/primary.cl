/* primary: keeps what the camera sees through each pixel, by slot, before the paths begin: their own first vertices,
 * and those of their neighbours' offset paths. */
//! traits: TRAIT_SHADING_NORMALS TRAIT_ANISOTROPIC
#include "kernels/shared/stage.h"

/* Rows of `camera`, before tracing. */
STAGE primary_begin(uint count, uint capacity, uint slots, __global const real *ray, __global const real *vertex,
                    __global real *primary) {
    const size_t row = work_item();
    if (row >= count)
        return;
    const uint slot = AT_UINT(vertex, slot, row);
    AT_UINT(primary, key_0, slot) = AT_UINT(vertex, key_0, row);
    AT_UINT(primary, key_1, slot) = AT_UINT(vertex, key_1, row);
    AT_UINT(primary, primitive, slot) = ray_escaped;
    AT_UINT(primary, kind, slot) = kind_none;
    const vec3 direction = AT_V3(ray, direction, row);
    SET_V3(primary, wi, slot, v3_neg(direction));
}

/* Their vertices. */
STAGE primary_surface(uint count, uint escaped, uint capacity, uint slots, __global const uint *index,
                      __global const real *ray, __global const real *vertex, __global const real *tangent,
                      __global const uint *material_kind, __global real *primary) {
    const size_t row = work_item();
    if (row >= count)
        return;
    const uint slot = AT_UINT(vertex, slot, row);
    const uint material_index = AT_UINT(vertex, material, row);
    AT_UINT(primary, primitive, slot) = AT_UINT(ray, primitive, index[escaped + row]);
    AT_UINT(primary, kind, slot) = material_kind[material_index];
    AT_UINT(primary, material, slot) = material_index;
    AT(primary, offset, slot) = AT(vertex, offset, row);
    const vec3 position = AT_V3(vertex, position, row), geometric = AT_V3(vertex, geometric, row);
    SET_V3(primary, position, slot, position);
    SET_V3(primary, geometric, slot, geometric);
#if TRAIT_SHADING_NORMALS
    const vec3 shading = AT_V3(vertex, shading, row);
    SET_V3(primary, shading, slot, shading);
#endif
#if TRAIT_ANISOTROPIC
    const vec3 along = AT_V3(tangent, along, row);
    SET_V3(primary, along, slot, along);
#endif
}
