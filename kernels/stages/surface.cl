/* surface: the new vertex of each path that hit something. Reads the ray and the old vertex of row index[i], writes
 * the new vertex, dense: position, normals on the side that was hit, material. */
//! traits: TRAIT_REFRACTION TRAIT_SHADING_NORMALS TRAIT_ANISOTROPIC TRAIT_TWO_SIDED TRAIT_TWO_FACED
//! traits: TRAIT_SPHERES TRAIT_TRIANGLES
#include "kernels/lib/scene_hit.h"
#include "kernels/shared/stage.h"

STAGE surface(uint count, uint unit, uint first, uint capacity, __global const uint *index, __global const real *ray,
              __global const real *vertex_old, __global real *vertex, __global real *shadow, __global real *tangent,
              __global const real *triangles, __global const real *triangle_normals,
              __global const real *triangle_tangents, __global const real *spheres, uint triangle_count,
              __global const uint *primitive_material, __global const uint *material_back) {
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
    const uint row = index[first + i];
    const uint primitive = AT_UINT(ray, primitive, row);
    const vec3 origin = AT_V3(ray, origin, row);
    const vec3 direction = AT_V3(ray, direction, row);
    const rgb throughput =
        rgb3(AT_IN(vertex_old, vertex, throughput_r, row), AT_IN(vertex_old, vertex, throughput_g, row),
             AT_IN(vertex_old, vertex, throughput_b, row));
    const primitive_hit hit = primitive_hit_of(triangles, spheres, unit, triangle_count, primitive, origin, direction);
    vec3 shading = hit.normal;
#if TRAIT_SHADING_NORMALS
#if TRAIT_SPHERES
    if (primitive < triangle_count)
#endif
        shading = v3_normalize(
            v3_mad(v3_mad(v3_scale(FIELD_V3(normals, triangle_normals, primitive, n0), R(1) - hit.u - hit.v), hit.u,
                          FIELD_V3(normals, triangle_normals, primitive, n1)),
                   hit.v, FIELD_V3(normals, triangle_normals, primitive, n2)));
#endif
    const uint sided_material = primitive_material[primitive];
    uint material_index = material_record(sided_material);
    vec3 geometric = hit.normal;
#if TRAIT_TWO_SIDED
    const int two_sided = (sided_material & material_two_sided) != 0u;
#if TRAIT_TWO_FACED
    const int turned = two_sided && v3_dot(hit.normal, direction) > R(0);
    const uint back = material_back[material_index];
    material_index = turned ? back : material_index;
#else
    const int turned = two_sided && v3_dot(shading, direction) > R(0);
#endif
    const real turn = turned ? R(-1) : R(1);
    geometric = v3_scale(geometric, turn);
    shading = v3_scale(shading, turn);
#endif

#if TRAIT_ANISOTROPIC
    vec3 along = v3(-hit.normal.y, hit.normal.x, R(0)); /* spheres: around the z axis */
#if TRAIT_SPHERES
    if (primitive < triangle_count)
#endif
        along = FIELD_V3(triangle_tangent, triangle_tangents, primitive, along);
    SET_V3(tangent, along, i, along);
#endif

    const real offset = primitive_offset(triangles, spheres, unit, triangle_count, primitive);
    AT_UINT(vertex, slot, i) = AT_UINT_IN(vertex_old, vertex, slot, row);
    AT_UINT(vertex, key_0, i) = AT_UINT_IN(vertex_old, vertex, key_0, row);
    AT_UINT(vertex, key_1, i) = AT_UINT_IN(vertex_old, vertex, key_1, row);
    AT_UINT(vertex, depth, i) = AT_UINT_IN(vertex_old, vertex, depth, row);
    SET_RGB(vertex, throughput, i, throughput);
#if TRAIT_REFRACTION
    AT(vertex, eta, i) = AT_IN(vertex_old, vertex, eta, row);
#endif
    SET_V3(vertex, position, i, hit.position);
    AT(vertex, offset, i) = offset;
    SET_V3(vertex, wi, i, v3_neg(direction));
    SET_V3(vertex, geometric, i, geometric);
#if TRAIT_SHADING_NORMALS
    SET_V3(vertex, shading, i, shading);
#endif
    AT_UINT(vertex, material, i) = material_index;
    AT_UINT(shadow, open, i) = 0u;
}
