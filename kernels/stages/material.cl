/* material: reads the textures of what each ray met, before `classify`: leaves in its row of `surface` the textured
 * parameters of the material there, those of GRADUS_TEXTURED_PARAMETERS in TRAIT_TEXTURED. A parameter that this
 * material has as a constant is left as that. `traced` is a table of rays, of traced_rows rows like `surface`.
 * Work-item i has the ray in row index[first + i].
 *
 * A kernel serves the materials of one class (runtime/scene/material_class.h). CLASS_TEXTURED, CLASS_LOOKUPS,
 * CLASS_BLENDS and CLASS_NORMALS are to it what TRAIT_TEXTURED, TRAIT_LOOKUPS, TRAIT_BLENDS and TRAIT_TEXTURED_NORMALS
 * are to the scene; the other traits of primitives and textures are those of the class. CLASS_ALL_TEXTURED has the
 * parameters that all of its materials have as textures. parameter_texture, blend_texture and normal_texture are
 * textures of the class, the first ones of their use.
 *
 * TRAIT_BLENDS: also the record that a blend has come to, chosen by a number of the path's key and depth, which its
 * offset paths share: so it is a coordinate of the paths that shifts keep. Of first vertices, where offset paths are
 * those of the neighbours, all pixels of a sample share it (TRAIT_SHARED_START). Of offset path j there are the rows
 * from j plane_rows on. OF_LIGHT_PATHS: rays of light paths.
 *
 * TRAIT_TEXTURED_NORMALS: also the normal that a map makes, as it is seen from the ray's side, and what goes with it
 * (kernels/lib/mapped_normal.h). */
//! traits: TRAIT_TEXTURED TRAIT_TWO_FACED TRAIT_SPHERES TRAIT_TRIANGLES TRAIT_BLENDS TRAIT_SHARED_START TRAIT_LOOKUPS
//! traits: TRAIT_TEXTURES TRAIT_BLEND_TEXTURES TRAIT_BLEND_LEVELS
//! traits: TRAIT_TEXTURED_NORMALS TRAIT_NORMAL_TEXTURES TRAIT_TWO_SIDED
#include "kernels/lib/division.h"
#include "kernels/lib/hit_uv.h"
#include "kernels/lib/mapped_normal.h"
#include "kernels/lib/material_lookup.h"
#include "kernels/lib/material_side.h"
#include "kernels/lib/normal_map.h"
#include "kernels/lib/path_draw.h"
#include "kernels/lib/sample_number.h"
#include "kernels/lib/surface_side.h"
#include "kernels/lib/texture_gradient.h"
#include "kernels/lib/textured_material.h"
#include "kernels/shared/stage.h"

/* Constants too: whoever reads a column of `surface` knows no class. */
#define LEAVE_COLOR(with, name, value, text)                                                                           \
    if (IS_TEXTURED(name)) {                                                                                           \
        surface[(size_t)textured_##name##_r * traced_rows + row] = m.name##_r;                                         \
        surface[(size_t)textured_##name##_g * traced_rows + row] = m.name##_g;                                         \
        surface[(size_t)textured_##name##_b * traced_rows + row] = m.name##_b;                                         \
    }
#define LEAVE_NUMBER(with, name, value, text)                                                                          \
    if (IS_TEXTURED(name))                                                                                             \
        surface[(size_t)textured_##name * traced_rows + row] = m.name;

STAGE read_material(uint count, uint unit, uint first, uint traced_rows, uint parameter_texture, uint blend_texture,
                    uint normal_texture, __global const uint *index, __global const real *traced,
                    __global real *surface, __global const real *triangles, __global const real *triangle_texcoords,
                    __global const real *spheres, __global const real *sphere_axes, uint triangle_count,
                    __global const uint *primitive_material, __global const real *materials,
                    __global const uint *material_textures, __global const uint *material_lookups,
                    __global const uint *textures, __global const real *texture_reals, __global const uint *texels
#if TRAIT_TWO_FACED || CLASS_NORMALS
                    ,
                    __global const real *triangle_normals
#endif
#if TRAIT_TWO_FACED
                    ,
                    __global const uint *material_back
#endif
#if CLASS_NORMALS
                    ,
                    __global const uint *normal_maps, __global const real *bump_scales
#endif
#if CLASS_BLENDS
                    ,
                    uint plane_rows, uint capacity, __global const uint *blends, __global const real *blend_weights
#if OF_LIGHT_PATHS
                    ,
                    __global const real *light_path
#else
                    ,
                    __global const real *path
#endif
#if TRAIT_SHARED_START
                    ,
                    uint first_sample_low, uint first_sample_high, uint pixels_multiplier, uint pixels_shift,
                    uint seed_low, uint seed_high
#endif
#endif
) {
    const size_t i = work_item();
    const uint kept = texture_bits(TRAIT_TEXTURES, parameter_texture, textures, texture_reals, unit) |
                      texture_bits(TRAIT_BLEND_TEXTURES, blend_texture, textures, texture_reals, unit) |
                      texture_bits(TRAIT_NORMAL_TEXTURES, normal_texture, textures, texture_reals, unit);
    if (!HAS_ROW(i, count, kept))
        return;
    const int row = AT_INDEX(first + i);
    const uint primitive = AT_UINT(traced, primitive, row);
    const vec3 direction = AT_V3(traced, direction, row);
    const primitive_hit hit =
        primitive_hit_of(triangles, spheres, unit, triangle_count, primitive INSTANCE_IN(traced, traced, row),
                         AT_V3(traced, origin, row), direction);
    uint record = material_record(OF_PRIMITIVE(primitive_material, material, primitive));
#if TRAIT_TWO_FACED
    const int behind = is_met_from_behind(triangle_normals, unit, triangle_count, primitive, hit, direction);
    record = material_on_side(material_back, OF_PRIMITIVE(primitive_material, material, primitive), behind);
#endif
    vec3 on_sphere = v3(R(0), R(0), R(1));
#if TRAIT_SPHERES
    const uint sphere = SPHERE_OF(primitive);
    on_sphere = hit_sphere_place(sphere_axes, spheres, unit, sphere, hit);
#endif
    const texture_point point = hit_texture_point(triangle_texcoords, unit, triangle_count, primitive, hit, on_sphere);
#if CLASS_BLENDS
    const uint base = row - plane_rows * ((uint)(row >= plane_rows) + (uint)(row >= 2u * plane_rows) +
                                          (uint)(row >= 3u * plane_rows));
#if OF_LIGHT_PATHS
    const uint key_0 = AT_UINT(light_path, key_0, base), key_1 = AT_UINT(light_path, key_1, base);
    const uint depth = AT_UINT(light_path, depth, base);
    real choice = random_draw(key_0, key_1, random_dimension_blend(depth)).a;
#else
    const uint key_0 = AT_UINT(path, key_0, base), key_1 = AT_UINT(path, key_1, base);
    const uint depth = AT_UINT(path, depth, base);
    real choice = PATH_DRAW(key_0, key_1, random_dimension_blend(depth)).a;
#endif
#if TRAIT_SHARED_START
    /* An additive sequence, as the places within the pixel are: what all pixels share does not average out. */
    const sample_place sample = shared_number_at(sample_place_after(
        first_sample_low, first_sample_high, divide(AT_UINT(path, slot, base), pixels_multiplier, pixels_shift)));
    const random_bits start = random_key(seed_low, seed_high, 0xFFFFFFFDu, 0u, sample.high);
#if TRAIT_STRATIFIED
    const real shared = random_unit(start.x + sample.low * 2654435769u);
#else
    const real shared = random_draw(start.x, sample.low, random_dimension_blend(0u)).a;
#endif
    choice = depth == 0u ? shared : choice;
#endif
#pragma unroll
    for (uint level = 0; level < CLASS_BLENDS; ++level) {
        const uint one = FIELD_OF(blend, blends, record, first), other = FIELD_OF(blend, blends, record, second);
        const int is_blend = one != blend_none;
        real weight = blend_weights[record];
        if ((TRAIT_BLEND_LEVELS >> min(level, 30u)) & 1) {
            const uint number = FIELD_OF(blend, blends, record, weight_texture);
            const real looked_up =
                rgb_luminance(texture_lookup(TRAIT_BLEND_TEXTURES, blend_texture, textures, texture_reals, texels, unit,
                                             texture_or_first(number, blend_texture), point));
            weight = texture_is_absent(number) ? weight : looked_up;
        }
        /* What is left of the number decides on the next level. */
        const int takes_second = choice < weight;
        const real rest = takes_second ? choice / weight : (choice - weight) / (R(1) - weight);
        record = is_blend ? (takes_second ? other : one) : record;
        choice = is_blend ? r_min(rest, R(0.99999994)) : choice;
    }
#endif
    const material m = material_looked_up(materials, record, point LOOKUP_ARGUMENTS);
    GRADUS_TEXTURED_PARAMETERS(LEAVE_COLOR, LEAVE_NUMBER, )
#if TRAIT_BLENDS
    *(GRADUS_GLOBAL uint *)(surface + (size_t)surface_record * traced_rows + row) = record;
#endif
#if CLASS_NORMALS
    vec3 along_u = v3(R(0), R(0), R(0)), along_v = along_u;
#if TRAIT_TRIANGLES
    const uint number = TRIANGLE_OF(primitive);
    const scene_triangle triangle = scene_triangle_of(triangles, unit, number INSTANCE_OF_HIT);
    const triangle_uv uv = HIT_UV(triangle_texcoords, unit, number, hit);
    const real u_1 = uv.u_1 - uv.u_0, v_1 = uv.v_1 - uv.v_0, u_2 = uv.u_2 - uv.u_0, v_2 = uv.v_2 - uv.v_0;
    const vec3 e1 = triangle.e1, e2 = triangle.e2;
    const real determinant = u_1 * v_2 - u_2 * v_1;
    const real inverse = determinant == R(0) ? R(0) : R(1) / determinant;
    along_u = v3_scale(v3_mad(v3_scale(e1, v_2), -v_1, e2), inverse);
    along_v = v3_scale(v3_mad(v3_scale(e2, u_1), -u_2, e1), inverse);
#endif
#if TRAIT_SPHERES
    const real x = on_sphere.x, y = on_sphere.y, z = on_sphere.z;
    const int is_sphere = !TRAIT_TRIANGLES || primitive >= triangle_count;
    const vec3 first_axis = FIELD_V3(sphere_axes, sphere_axes, sphere, first);
    const vec3 second_axis = FIELD_V3(sphere_axes, sphere_axes, sphere, second);
    const vec3 third_axis = FIELD_V3(sphere_axes, sphere_axes, sphere, third);
    const real sine = r_sqrt(x * x + y * y), inverse_sine = sine > R(0) ? R(1) / sine : R(0);
    const real half_turn = R(3.14159265358979) * r_abs(FIELD_OF(sphere, spheres, sphere, radius));
    const vec3 meridian =
        v3_sub(v3_scale(v3_mad(v3_scale(first_axis, x), y, second_axis), z * inverse_sine), v3_scale(third_axis, sine));
    along_u =
        v3_select(is_sphere, v3_scale(v3_mad(v3_scale(second_axis, x), -y, first_axis), R(2) * half_turn), along_u);
    along_v = v3_select(is_sphere, v3_scale(meridian, half_turn), along_v);
#endif
    const uint map_flags = FIELD_OF(normal_map, normal_maps, record, flags);
    const uint map_texture = texture_or_first(FIELD_OF(normal_map, normal_maps, record, texture), normal_texture);
    const textured_surface place = textured_surface_at(
        hit.normal, shading_normal_at(triangle_normals, unit, triangle_count, primitive, hit), along_u, along_v);
    vec3 mapped = place.shading;
#if CLASS_NORMALS & textured_normals_given
    const rgb map_color = texture_lookup(TRAIT_NORMAL_TEXTURES, normal_texture, textures, texture_reals, texels, unit,
                                         map_texture, point);
    mapped = normal_of_color(place, map_color);
#endif
#if CLASS_NORMALS & textured_normals_bump
    const texture_slope slope = texture_gradient(TRAIT_NORMAL_TEXTURES, normal_texture, textures, texture_reals, texels,
                                                 unit, map_texture, point.u, point.v);
    const real bump_scale = bump_scales[record];
    const vec3 bumped = normal_of_height(place, bump_scale * slope.u, bump_scale * slope.v);
    mapped = v3_select((map_flags & normal_map_is_bump) != 0u, bumped, mapped);
#endif
    uint vertex_flags = map_flags & normal_map_of_vertex;
#if TRAIT_TWO_SIDED
    const int is_two_sided = (OF_PRIMITIVE(primitive_material, material, primitive) & material_two_sided) != 0u;
    vertex_flags |= is_two_sided & (vertex_flags != 0u) ? normal_map_on_two_sided : 0u;
    const int is_from_behind = is_two_sided & (v3_dot(place.shading, direction) > R(0));
    const vec3 from_behind = normal_from_behind(place.shading, mapped, (map_flags & normal_map_is_outside) != 0u);
    mapped = v3_select(is_from_behind, from_behind, mapped);
#endif
    surface[(size_t)textured_normal_x * traced_rows + row] = mapped.x;
    surface[(size_t)textured_normal_y * traced_rows + row] = mapped.y;
    surface[(size_t)textured_normal_z * traced_rows + row] = mapped.z;
    surface[(size_t)textured_normal_flags * traced_rows + row] = (real)(int)vertex_flags;
#elif TRAIT_TEXTURED_NORMALS
    surface[(size_t)textured_normal_x * traced_rows + row] = R(0);
    surface[(size_t)textured_normal_y * traced_rows + row] = R(0);
    surface[(size_t)textured_normal_z * traced_rows + row] = R(1);
    surface[(size_t)textured_normal_flags * traced_rows + row] = R(0);
#endif
}
