/* primary: keeps what the camera sees through each pixel of a strip and of the rows beside it, by slot, before the
 * paths begin: the first vertices of their own, and those of their neighbours' offset paths. Rows are those of
 * `camera`, after tracing, and have the slots from `first_slot` on. */
//! traits: TRAIT_CAMERA_ORIGINS TRAIT_INSTANCES
#include "kernels/lib/surface_point.h"
#include "kernels/lib/textured_material.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/stage.h"

STAGE primary(uint count, uint unit, uint capacity, uint slots, uint first_slot, __global const real *ray,
              __global const real *path, __global real *primary, __global real *primary_vertex,
              __global const real *triangles, __global const real *triangle_normals,
              __global const real *triangle_tangents, __global const real *spheres, uint triangle_count,
              __global const uint *primitive_material, __global const uint *material_back,
              __global const uint *material_kind SURFACE_ARGUMENT) {
    const size_t row = work_item();
    if (row >= count)
        return;
    const size_t slot = (size_t)first_slot + row;
    const uint primitive = AT_UINT(ray, primitive, row);
    const vec3 direction = AT_V3(ray, direction, row);
    const int is_hit = primitive < ray_first_special;
    const surface_point point = CHOSEN_POINT(surface_point_of(triangles, triangle_normals, triangle_tangents, spheres,
                                                              unit, triangle_count, primitive_material, material_back,
                                                              is_hit ? primitive : 0u INSTANCE_IN(ray, ray, row),
                                                              AT_V3(ray, origin, row), direction),
                                             capacity, row);
    AT_UINT(primary, key_0, slot) = AT_UINT(path, key_0, row);
    AT_UINT(primary, key_1, slot) = AT_UINT(path, key_1, row);
    AT_UINT(primary, primitive, slot) = primitive;
#if TRAIT_INSTANCES
    AT_UINT(primary, instance, slot) = AT_UINT(ray, instance, row);
#endif
    SET_V3(primary, direction, slot, direction);
#if TRAIT_CAMERA_ORIGINS
    SET_V3(primary, origin, slot, AT_V3(ray, origin, row));
#endif
    SET_SURFACE_VERTEX(primary_vertex, slot, is_hit ? material_kind[point.material] : kind_none, point, direction)
    SET_VERTEX_TEXTURED(primary_vertex, slot, capacity, row)
}
