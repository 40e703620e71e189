/* emission: adds the light that a path finds at an emitting surface, weighted against light sampling: rows
 * index[first] on. Runs before `surface`, on the old vertices. */
//! traits: TRAIT_LIGHT_TRIANGLE TRAIT_LIGHT_SPHERE TRAIT_HIDE_EMITTERS
#include "kernels/lib/light.h"
#include "kernels/lib/mis.h"
#include "kernels/lib/scene_hit.h"
#include "kernels/shared/stage.h"

STAGE emission(uint count, uint unit, uint first, uint capacity, uint slots, __global const uint *index,
               __global const real *ray, __global const real *vertex_old, __global real *radiance,
               __global const real *triangles, __global const real *spheres, uint triangle_count,
               __global const uint *primitive_light, __global const real *lights) {
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
    const uint row = index[first + i];
    const uint slot = AT_UINT_IN(vertex_old, vertex, slot, row);
    const uint primitive = AT_UINT(ray, primitive, row);
    const vec3 origin = AT_V3(ray, origin, row);
    const vec3 direction = AT_V3(ray, direction, row);
    const primitive_hit hit = primitive_hit_of(triangles, spheres, unit, triangle_count, primitive, origin, direction);
    const real side = -v3_dot(hit.normal, direction);
    const vec3 connection = v3_sub(hit.position, origin);
    const real distance_squared = v3_dot(connection, connection);

    const uint light = primitive_light[primitive];
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
    real weight =
        mis_weight_bsdf(AT_IN(vertex_old, vertex, pdf, row), pdf_light * FIELD_OF(light, lights, light, probability));
    weight = side > R(0) ? weight : R(0);
#if TRAIT_HIDE_EMITTERS
    weight = AT_UINT_IN(vertex_old, vertex, depth, row) > 0u ? weight : R(0);
#endif
    AT(radiance, value_r, slot) +=
        weight * FIELD_OF(light, lights, light, value_r) * AT_IN(vertex_old, vertex, throughput_r, row);
    AT(radiance, value_g, slot) +=
        weight * FIELD_OF(light, lights, light, value_g) * AT_IN(vertex_old, vertex, throughput_g, row);
    AT(radiance, value_b, slot) +=
        weight * FIELD_OF(light, lights, light, value_b) * AT_IN(vertex_old, vertex, throughput_b, row);
}
