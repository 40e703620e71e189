/* light_sample: connects each vertex of one BSDF kind (rows `first` on) to a point of a light chosen by power. Leaves
 * the connection in `shadow`, with what the path gains if nothing is in between. */
//! traits: TRAIT_LIGHT_TRIANGLE TRAIT_LIGHT_SPHERE TRAIT_LIGHT_POINT TRAIT_LIGHT_DIRECTIONAL TRAIT_LIGHT_CONSTANT
#include "kernels/lib/bsdf.h"
#include "kernels/lib/light.h"
#include "kernels/lib/mis.h"
#include "kernels/lib/random.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/stage.h"

#define LIGHT_KINDS                                                                                                    \
    (TRAIT_LIGHT_TRIANGLE + TRAIT_LIGHT_SPHERE + TRAIT_LIGHT_POINT + TRAIT_LIGHT_DIRECTIONAL + TRAIT_LIGHT_CONSTANT)
#if LIGHT_KINDS > 1
#define IF_LIGHT(name) if (kind == light_kind_##name)
#else
#define IF_LIGHT(name)
#endif

STAGE light_sample(uint count, uint unit, uint first, uint capacity, uint max_depth, __global const real *vertex,
                   __global const real *tangent, __global real *shadow, __global const real *materials,
                   __global const real *lights, __global const uint *light_kinds, __global const uint *light_alias,
                   uint light_count, real scene_diameter) {
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
    const size_t row = first + i;
    const uint depth = AT_UINT(vertex, depth, row);
    const random4 u =
        random_draw(AT_UINT(vertex, key_0, row), AT_UINT(vertex, key_1, row), random_dimension_light(depth));
    const uint column = min((uint)(u.a * (real)light_count), light_count - 1u);
    const uint light = u.b < FIELD_OF(light, lights, column, alias_threshold) ? column : light_alias[column];
    const real probability = FIELD_OF(light, lights, light, probability);
    const rgb value = rgb3(FIELD_OF(light, lights, light, value_r), FIELD_OF(light, lights, light, value_g),
                           FIELD_OF(light, lights, light, value_b));
    const vec3 position = AT_V3(vertex, position, row);
    const vec3 p = FIELD_V3(light, lights, light, p);
#if TRAIT_LIGHT_TRIANGLE || TRAIT_LIGHT_SPHERE
    const vec3 e1 = FIELD_V3(light, lights, light, e1);
#endif
#if LIGHT_KINDS > 1
    const uint kind = light_kinds[light];
#endif

    light_choice s;
    s.direction = v3(R(0), R(0), R(1));
    s.connection = s.direction;
    s.normal = v3(R(0), R(0), R(0));
    s.value = rgb_gray(R(0));
    s.pdf = R(0);
#if TRAIT_LIGHT_TRIANGLE
    IF_LIGHT(triangle)
    s = light_from_triangle(value, p, e1, FIELD_V3(light, lights, light, e2), position, u.c, u.d);
#endif
#if TRAIT_LIGHT_SPHERE
    IF_LIGHT(sphere)
    s = light_from_sphere(value, p, e1.x, e1.y, FIELD_OF(light, lights, light, inverse_area), position, u.c, u.d);
#endif
#if TRAIT_LIGHT_POINT
    IF_LIGHT(point) {
        s.connection = v3_sub(p, position);
        const real inverse_squared = R(1) / r_max(v3_dot(s.connection, s.connection), R(1e-36));
        s.direction = v3_scale(s.connection, r_sqrt(inverse_squared));
        s.value = rgb_scale(value, inverse_squared);
    }
#endif
#if TRAIT_LIGHT_DIRECTIONAL
    IF_LIGHT(directional) {
        s.direction = p;
        s.connection = v3_scale(p, scene_diameter);
        s.value = value;
    }
#endif
#if TRAIT_LIGHT_CONSTANT
    IF_LIGHT(constant) {
        s.direction = warp_uniform_sphere(u.c, u.d);
        s.connection = v3_scale(s.direction, scene_diameter);
        s.pdf = R(0.25) * GRADUS_INV_PI;
        s.value = rgb_scale(value, R(4) * GRADUS_PI);
    }
#endif

    const material m = material_load(materials, AT_UINT(vertex, material, row), unit);
    const frame axes = VERTEX_FRAME(row, m);
    const vec3 wi = frame_to_local(axes, AT_V3(vertex, wi, row));
    const vec3 wo = frame_to_local(axes, s.direction);
    const rgb reflected = PASTE(BSDF, _eval)(m, wi, wo);
    const real pdf_bsdf = PASTE(BSDF, _pdf)(m, wi, wo);
    const real weight = mis_weight_light(s.pdf * probability, pdf_bsdf) / probability;
    const rgb gain = rgb_scale(rgb_mul(rgb_mul(AT_RGB(vertex, throughput, row), s.value), reflected), weight);

    const vec3 geometric = AT_V3(vertex, geometric, row);
    const real off = AT(vertex, offset, row) * r_copysign1(v3_dot(geometric, s.direction));
    const vec3 origin = v3_mad(position, off, geometric);
    const vec3 target = v3_mad(v3_add(position, s.connection), FIELD_OF(light, lights, light, offset), s.normal);
    SET_V3(shadow, origin, row, origin);
    SET_V3(shadow, direction, row, v3_sub(target, origin));
    SET_RGB(shadow, value, row, gain);
    AT_UINT(shadow, open, row) = depth + 1u < max_depth && rgb_max(gain) > R(0) ? 1u : 0u;
}
