/* surface: the new vertex of each path that hit something. Reads the ray and the old vertex of row index[i], writes
 * the new vertex, dense: position, normals on the side that was hit, material, and what the path gains from the
 * emission found there, weighted against light sampling. */
//! traits: TRAIT_REFRACTION TRAIT_SHADING_NORMALS TRAIT_ANISOTROPIC TRAIT_TWO_SIDED TRAIT_TWO_FACED
//! traits: TRAIT_LIGHT_TRIANGLE TRAIT_LIGHT_SPHERE TRAIT_HIDE_EMITTERS TRAIT_SPHERES TRAIT_TRIANGLES
#include "kernels/lib/light.h"
#include "kernels/lib/mis.h"
#include "kernels/lib/scene_hit.h"
#include "kernels/shared/stage.h"

STAGE surface(uint count, uint unit, uint first, uint capacity, uint depth, __global const uint *index, __global const real *ray,
              __global const real *vertex_old, __global real *vertex, __global real *shadow, __global real *tangent,
              __global const real *triangles, __global const real *triangle_normals,
              __global const real *triangle_tangents, __global const real *spheres, uint triangle_count,
              __global const uint *primitive_material, __global const uint *primitive_light,
              __global const uint *material_flags, __global const uint *material_back, __global const real *lights) {
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
    const primitive_hit hit =
        primitive_hit_of(triangles, spheres, unit, triangle_count, primitive, origin, direction);
    const real side = -v3_dot(hit.normal, direction);

    rgb emitted = rgb_gray(R(0));
#if TRAIT_LIGHT_TRIANGLE || TRAIT_LIGHT_SPHERE
    const uint light_or_none = primitive_light[primitive];
    const uint light = light_or_none == no_light ? 0u : light_or_none;
    const vec3 connection = v3_sub(hit.position, origin);
    const real distance_squared = v3_dot(connection, connection);
    const real inverse_area = FIELD_OF(light, lights, light, inverse_area);
    real pdf_light = light_area_pdf(inverse_area, distance_squared, side);
#if TRAIT_LIGHT_SPHERE && TRAIT_LIGHT_TRIANGLE
    if (primitive >= triangle_count)
#endif
#if TRAIT_LIGHT_SPHERE
    {
        const vec3 to_center = v3_sub(FIELD_V3(light, lights, light, p), origin);
        pdf_light = light_sphere_pdf(FIELD_OF(light, lights, light, e1_x), FIELD_OF(light, lights, light, e1_y),
                                     inverse_area, v3_dot(to_center, to_center), distance_squared, side);
    }
#endif
    const real weight = mis_weight_bsdf(AT_IN(vertex_old, vertex, pdf, row),
                                        pdf_light * FIELD_OF(light, lights, light, probability));
    int seen = light_or_none != no_light && side > R(0);
#if TRAIT_HIDE_EMITTERS
    seen = seen && depth > 0u;
#endif
    const rgb radiance = rgb3(FIELD_OF(light, lights, light, value_r), FIELD_OF(light, lights, light, value_g),
                              FIELD_OF(light, lights, light, value_b));
    emitted = rgb_scale(rgb_mul(throughput, radiance), seen ? weight : R(0));
#endif

    vec3 shading = hit.normal;
#if TRAIT_SHADING_NORMALS
#if TRAIT_SPHERES
    if (primitive < triangle_count)
#endif
        shading = v3_normalize(v3_mad(v3_mad(v3_scale(FIELD_V3(normals, triangle_normals, primitive, n0),
                                                      R(1) - hit.u - hit.v),
                                             hit.u, FIELD_V3(normals, triangle_normals, primitive, n1)),
                                      hit.v, FIELD_V3(normals, triangle_normals, primitive, n2)));
#endif
    uint material = primitive_material[primitive];
    vec3 geometric = hit.normal;
#if TRAIT_TWO_SIDED
#if TRAIT_TWO_FACED
    const int behind = side < R(0);
    const int turned = behind && (material_flags[material] & material_flag_two_sided) != 0u;
    material = turned ? material_back[material] : material;
#else
    const int turned = v3_dot(shading, direction) > R(0) && (material_flags[material] & material_flag_two_sided) != 0u;
#endif
    geometric = v3_scale(geometric, turned ? R(-1) : R(1));
    shading = v3_scale(shading, turned ? R(-1) : R(1));
#endif

#if TRAIT_ANISOTROPIC
    vec3 along = v3(-hit.normal.y, hit.normal.x, R(0)); /* spheres: around the z axis */
#if TRAIT_SPHERES
    if (primitive < triangle_count)
#endif
        along = FIELD_V3(triangle_tangent, triangle_tangents, primitive, along);
    SET_V3(tangent, along, i, along);
#endif

    real offset = R(0);
#if TRAIT_TRIANGLES && TRAIT_SPHERES
    if (primitive < triangle_count)
#endif
#if TRAIT_TRIANGLES
        offset = FIELD_OF(triangle, triangles, primitive, offset);
#endif
#if TRAIT_TRIANGLES && TRAIT_SPHERES
    if (primitive >= triangle_count)
#endif
#if TRAIT_SPHERES
        offset = FIELD_OF(sphere, spheres, primitive - triangle_count, offset);
#endif

    AT_UINT(vertex, slot, i) = AT_UINT_IN(vertex_old, vertex, slot, row);
    AT_UINT(vertex, key_0, i) = AT_UINT_IN(vertex_old, vertex, key_0, row);
    AT_UINT(vertex, key_1, i) = AT_UINT_IN(vertex_old, vertex, key_1, row);
    SET_RGB(vertex, throughput, i, throughput);
#if TRAIT_REFRACTION
    AT(vertex, eta, i) = AT_IN(vertex_old, vertex, eta, row);
#endif
    SET_V3(vertex, position, i, hit.position);
    AT(vertex, offset, i) = offset;
    SET_V3(vertex, wi, i, v3_neg(direction));
    SET_V3(vertex, geometric, i, geometric);
    SET_V3(vertex, shading, i, shading);
    AT_UINT(vertex, material, i) = material;
    SET_RGB(vertex, emitted, i, emitted);
    AT_UINT(shadow, open, i) = 0u;
}
