/* emit: begins one light path a row. Leaves its first ray, its random key and its power.
 *
 * Light paths take rows `first_row` on and slots `first_slot` on; the one of slot 0 has the 64-bit number
 * `first_path_high`, `first_path_low`, by which its random numbers go. */
//! traits: TRAIT_LIGHT_VERTICES TRAIT_LIGHT_STARTS
#include "kernels/lib/light_beam.h"
#include "kernels/lib/light_emission.h"
#include "kernels/shared/light_vertex.h"
#include "kernels/shared/stage.h"

STAGE emit(uint count, uint unit, uint capacity, uint first_row, uint first_slot, uint first_path_low,
           uint first_path_high, uint seed_low, uint seed_high, __global real *ray, __global real *light_path,
           __global uint *photon_place, __global const real *lights, __global const uint *light_kinds,
           __global const real *emissions, __global const uint *emission_alias, uint light_count, real scene_center_x,
           real scene_center_y, real scene_center_z, real scene_diameter ENVIRONMENT_PARAMETERS LIGHT_TEXTURE_PARAMETERS
#if TRAIT_LIGHT_STARTS
           ,
           __global real *light_vertices, __global uint *light_vertex_marks, uint to_vertex
#endif
) {
    const size_t i = work_item();
#if TRAIT_TEXTURED_LIGHTS
    if (!HAS_ROW(i, count, texture_bits(TRAIT_LIGHT_TEXTURES, 0u, textures, texture_reals, unit)))
#else
    if (i >= count)
#endif
        return;
    const size_t row = first_row + i;
    const uint slot = first_slot + (uint)i;
    const uint low = first_path_low + slot;
    const uint high = first_path_high + (low < first_path_low ? 1u : 0u);
    const random_bits key = random_key(seed_low, seed_high, random_pixel_of_lights, low, high);
    const random4 choice = random_draw(key.x, key.y, random_dimension_emission);
    const random4 leaving = random_draw(key.x, key.y, random_dimension_leaving);
    const light_emission emitted = emission_sampling(
        lights, light_kinds, emissions, emission_alias, light_count, v3(scene_center_x, scene_center_y, scene_center_z),
        R(0.5) * scene_diameter, unit, choice, leaving ENVIRONMENT_ARGUMENTS LIGHT_TEXTURE_ARGUMENTS);
    SET_V3(ray, origin, row, emitted.origin);
    SET_V3(ray, direction, row, emitted.direction);
    /* Where a picture or a texture is black nothing is sent, or it would be moved to where there is light; who comes from
     * there has no way back. */
    AT_UINT(ray, primitive, row) = rgb_max(emitted.power) > R(0) ? ray_pending : ray_none;
    AT_UINT(light_path, slot, row) = slot;
    AT_UINT(light_path, key_0, row) = key.x;
    AT_UINT(light_path, key_1, row) = key.y;
    AT_UINT(light_path, depth, row) = 0u;
    AT_UINT(light_path, stored, row) = 0u;
    SET_RGB(light_path, power, row, emitted.power);
    AT(light_path, start, row) = rgb_max(emitted.power);
#if TRAIT_LIGHT_VERTICES && !TRAIT_LIGHT_STARTS
    AT_UINT(light_path, vertex, row) = light_vertex_none;
#endif
#if TRAIT_LIGHT_STARTS
    const uint record = to_vertex + (uint)i;
    const vec3 none = v3(R(0), R(0), R(0));
    SET_FIELD_V3(light_vertex, light_vertices, record, position, emitted.origin);
    SET_FIELD_V3(light_vertex, light_vertices, record, geometric, emitted.normal);
    SET_FIELD_V3(light_vertex, light_vertices, record, wi, none);
    const int is_on_surface = emitted.starts == light_vertex_on_surface;
    const real by_angle = GRADUS_INV_PI * (is_on_surface ? v3_dot(emitted.normal, emitted.direction) : R(0.25));
    const int is_far = emitted.starts == light_vertex_at_infinity;
    real pdf = is_far ? R(1) : by_angle;
    rgb arriving = emitted.power;
#if LIGHTS_HAVE_BEAMS
    const int is_beam = emitted.starts == light_vertex_of_beam;
    const light_beam beam =
        light_beam_towards(lights, light_kinds, emitted.light, unit, emitted.direction LIGHT_TEXTURE_ARGUMENTS);
    /* By rounding, a direction may lie beside the picture: nothing is moved from there, as nothing is moved there. */
    pdf = is_beam ? (beam.pdf > R(0) ? beam.pdf : R(1e30)) : pdf;
    arriving = rgb_select(is_beam, emitted.value, arriving);
#endif
    FIELD_OF(light_vertex, light_vertices, record, power_r) = arriving.r;
    FIELD_OF(light_vertex, light_vertices, record, power_g) = arriving.g;
    FIELD_OF(light_vertex, light_vertices, record, power_b) = arriving.b;
    FIELD_OF(light_vertex, light_vertices, record, offset) = is_far ? chain_start_at_infinity : R(0);
    FIELD_OF(light_vertex, light_vertices, record, pdf) = pdf;
    FIELD_OF(light_vertex, light_vertices, record, survival) = R(1);
    FIELD_OF(light_vertex_mark, light_vertex_marks, record, material) = emitted.starts;
    FIELD_OF(light_vertex_mark, light_vertex_marks, record, primitive) = emitted.light;
    FIELD_OF(light_vertex_mark, light_vertex_marks, record, before) = light_vertex_none;
#if TRAIT_MIXED_LOBES
    FIELD_OF(light_vertex_mark, light_vertex_marks, record, mirrors) = 0u;
#endif
    AT_UINT(light_path, vertex, row) = record;
#endif
    photon_place[slot] = 0u;
}
