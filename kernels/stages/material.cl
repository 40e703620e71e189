/* material: reads the textures of what each ray met, before `classify`: leaves in its row of `surface` the textured
 * parameters of the material there, those of GRADUS_TEXTURED_PARAMETERS in TRAIT_TEXTURED. A parameter that this
 * material has as a constant is left as that. `traced` is a table of rays, of traced_rows rows like `surface`. Rays
 * that met nothing leave what nobody reads. TRAIT_TEXTURED_LIGHTS: also what the light of an emitting surface is times.
 *
 * TRAIT_BLENDS: also the record that a blend has come to, chosen by a number of the path's key and depth, which its
 * offset paths share: so it is a coordinate of the paths that shifts keep. Of first vertices, where offset paths are
 * those of the neighbours, all pixels of a sample share it (TRAIT_SHARED_JITTER). Plane j has the rays of offset path
 * j, plane_rows rows further on each. OF_LIGHT_PATHS: rays of light paths. */
//! traits: TRAIT_TEXTURED TRAIT_TEXTURED_LIGHTS TRAIT_TWO_FACED TRAIT_SPHERES TRAIT_TRIANGLES TRAIT_BLENDS
//! TRAIT_SHARED_JITTER
#include "kernels/lib/division.h"
#include "kernels/lib/light_texture.h"
#include "kernels/lib/material_side.h"
#include "kernels/lib/random.h"
#include "kernels/lib/surface_side.h"
#include "kernels/lib/surface_uv.h"
#include "kernels/lib/textured_material.h"
#include "kernels/shared/stage.h"

#define LOOK_UP(name)                                                                                                  \
    const uint number = material_textures[(size_t)record * textured_parameters + parameter_##name * (size_t)unit];     \
    const int is_constant = number == texture_none;                                                                    \
    const rgb looked_up =                                                                                              \
        texture_lookup(textures, texture_reals, texels, texture_decode, unit, is_constant ? 0u : number, point);       \
    GRADUS_GLOBAL const real *constants = materials + (size_t)record * material_stride;
#define LEAVE(field, value)                                                                                            \
    surface[(size_t)textured_##field * traced_rows + row] =                                                            \
        is_constant ? constants[material_##field * (size_t)unit] : (value);
#define LEAVE_COLOR(with, name, value, text)                                                                           \
    if (IS_TEXTURED(name)) {                                                                                           \
        LOOK_UP(name)                                                                                                  \
        LEAVE(name##_r, looked_up.r)                                                                                   \
        LEAVE(name##_g, looked_up.g)                                                                                   \
        LEAVE(name##_b, looked_up.b)                                                                                   \
    }
/* Of a coloured texture its luminance. */
#define LEAVE_NUMBER(with, name, value, text)                                                                          \
    if (IS_TEXTURED(name)) {                                                                                           \
        LOOK_UP(name)                                                                                                  \
        LEAVE(name, rgb_luminance(looked_up))                                                                          \
    }

STAGE read_material(uint count, uint unit, uint traced_rows, __global const real *traced, __global real *surface,
                    __global const real *triangles, __global const real *triangle_texcoords,
                    __global const real *spheres, __global const real *sphere_axes, uint triangle_count,
                    __global const uint *primitive_material, __global const real *materials,
                    __global const uint *material_textures, __global const uint *textures,
                    __global const real *texture_reals, __global const uint *texels, __global const real *texture_decode
#if TRAIT_TEXTURED_LIGHTS & 1
                    ,
                    __global const uint *primitive_light, __global const uint *light_textures, uint light_count
#endif
#if TRAIT_TWO_FACED
                    ,
                    __global const real *triangle_normals, __global const uint *material_back
#endif
#if TRAIT_BLENDS
                    ,
                    uint plane_rows, uint capacity, __global const uint *blends, __global const real *blend_weights
#if OF_LIGHT_PATHS
                    ,
                    __global const real *light_path
#else
                    ,
                    __global const real *path
#endif
#if TRAIT_SHARED_JITTER
                    ,
                    uint first_sample_low, uint first_sample_high, uint pixels_multiplier, uint pixels_shift,
                    uint seed_low, uint seed_high
#endif
#else
                    ,
                    uint plane_rows
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = (size_t)get_global_id(2) * plane_rows + i;
    const uint met = AT_UINT(traced, primitive, row);
    const uint primitive = met < ray_first_special ? met : 0u;
    const vec3 direction = AT_V3(traced, direction, row);
    const primitive_hit hit =
        primitive_hit_of(triangles, spheres, unit, triangle_count, primitive, AT_V3(traced, origin, row), direction);
    uint record = material_record(primitive_material[primitive]);
#if TRAIT_TWO_FACED
    const int behind = is_met_from_behind(triangle_normals, unit, triangle_count, primitive, hit, direction);
    record = material_on_side(material_back, primitive_material[primitive], behind);
#endif
    texture_point point = point_of_nothing();
#if TRAIT_TRIANGLES
    point = point_of_triangle(triangle_texcoords, unit, TRIANGLE_OF(primitive), hit.u, hit.v);
#endif
#if TRAIT_SPHERES
    const uint sphere = SPHERE_OF(primitive);
    const texture_point on_sphere = point_of_sphere(
        sphere_axes, unit, sphere, v3_scale(hit.normal, FIELD_OF(sphere, spheres, sphere, facing)), point);
    const int is_sphere = !TRAIT_TRIANGLES || primitive >= triangle_count;
    point.u = is_sphere ? on_sphere.u : point.u;
    point.v = is_sphere ? on_sphere.v : point.v;
#endif
#if TRAIT_BLENDS
#if OF_LIGHT_PATHS
    const uint key_0 = AT_UINT(light_path, key_0, i), key_1 = AT_UINT(light_path, key_1, i);
    const uint depth = AT_UINT(light_path, depth, i);
#else
    const uint key_0 = AT_UINT(path, key_0, i), key_1 = AT_UINT(path, key_1, i);
    const uint depth = AT_UINT(path, depth, i);
#endif
    real choice = random_draw(key_0, key_1, random_dimension_blend(depth)).a;
#if TRAIT_SHARED_JITTER
    /* An additive sequence, as the places within the pixel are: what all pixels share does not average out. */
    const uint sample = first_sample_low + divide(AT_UINT(path, slot, i), pixels_multiplier, pixels_shift);
    const uint high = first_sample_high + (sample < first_sample_low ? 1u : 0u);
    const random_bits start = random_key(seed_low, seed_high, 0xFFFFFFFDu, 0u, high);
    const real shared = random_unit(start.x + sample * 2654435769u);
    choice = depth == 0u ? shared : choice;
#endif
#pragma unroll
    for (uint level = 0; level < TRAIT_BLENDS; ++level) {
        const uint first = FIELD_OF(blend, blends, record, first), second = FIELD_OF(blend, blends, record, second);
        const int is_blend = first != blend_none;
        real weight = blend_weights[record];
#if TRAIT_TEXTURES
        const uint number = FIELD_OF(blend, blends, record, weight_texture);
        const int is_constant = number == texture_none;
        const real looked_up = rgb_luminance(
            texture_lookup(textures, texture_reals, texels, texture_decode, unit, is_constant ? 0u : number, point));
        weight = is_constant ? weight : looked_up;
#endif
        /* What is left of the number decides on the next level. */
        const int takes_second = choice < weight;
        const real rest = takes_second ? choice / weight : (choice - weight) / (R(1) - weight);
        record = is_blend ? (takes_second ? second : first) : record;
        choice = is_blend ? r_min(rest, R(0.99999994)) : choice;
    }
    *(GRADUS_GLOBAL uint *)(surface + (size_t)surface_record * traced_rows + row) = record;
#endif
    GRADUS_TEXTURED_PARAMETERS(LEAVE_COLOR, LEAVE_NUMBER, )
#if TRAIT_TEXTURED_LIGHTS & 1
    const uint named = primitive_light[primitive];
    const rgb of_light = light_texture_at(light_textures, textures, texture_reals, texels, texture_decode, unit,
                                          named < light_count ? named : light_count, point);
    surface[(size_t)surface_emission_r * traced_rows + row] = of_light.r;
    surface[(size_t)surface_emission_g * traced_rows + row] = of_light.g;
    surface[(size_t)surface_emission_b * traced_rows + row] = of_light.b;
#endif
}
