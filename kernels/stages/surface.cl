/* surface: the new vertex of each path that hit something. Reads the ray and the old vertex of row index[i], writes
 * the new vertex, dense: position, normals on the side that was hit, material. */
//! traits: TRAIT_REFRACTION TRAIT_SHADING_NORMALS TRAIT_ANISOTROPIC
#include "kernels/lib/surface_point.h"
#include "kernels/shared/stage.h"

STAGE surface(uint count, uint unit, uint first, uint capacity, __global const uint *index, __global const real *ray,
              __global const real *vertex_old, __global real *vertex, __global real *shadow, __global real *tangent,
              __global const real *triangles, __global const real *triangle_normals,
              __global const real *triangle_tangents, __global const real *spheres, uint triangle_count,
              __global const uint *primitive_material, __global const uint *material_back) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const uint row = index[first + i];
    const vec3 direction = AT_V3(ray, direction, row);
    const rgb throughput = AT_RGB_IN(vertex_old, vertex, throughput, row);
    const surface_point point = surface_point_of(triangles, triangle_normals, triangle_tangents, spheres, unit,
                                                 triangle_count, primitive_material, material_back,
                                                 AT_UINT(ray, primitive, row), AT_V3(ray, origin, row), direction);
#if TRAIT_ANISOTROPIC
    SET_V3(tangent, along, i, point.along);
#endif
    AT_UINT(vertex, slot, i) = AT_UINT_IN(vertex_old, vertex, slot, row);
    AT_UINT(vertex, key_0, i) = AT_UINT_IN(vertex_old, vertex, key_0, row);
    AT_UINT(vertex, key_1, i) = AT_UINT_IN(vertex_old, vertex, key_1, row);
    AT_UINT(vertex, depth, i) = AT_UINT_IN(vertex_old, vertex, depth, row);
    SET_RGB(vertex, throughput, i, throughput);
#if TRAIT_REFRACTION
    AT(vertex, eta, i) = AT_IN(vertex_old, vertex, eta, row);
#endif
    SET_V3(vertex, position, i, point.position);
    AT(vertex, offset, i) = point.offset;
    SET_V3(vertex, wi, i, v3_neg(direction));
    SET_V3(vertex, geometric, i, point.geometric);
#if TRAIT_SHADING_NORMALS
    SET_V3(vertex, shading, i, point.shading);
#endif
    AT_UINT(vertex, material, i) = point.material;
    AT_UINT(shadow, open, i) = 0u;
}
