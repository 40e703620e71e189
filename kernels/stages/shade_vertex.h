/* What shading a vertex does, however its material's parameters are found (shade.cl, shade_textured.cl):
 * MATERIAL_PARAMETERS are the arguments for that, with a comma before each, MATERIAL_AT(point, primitive, hit) the
 * material, and BITS_OF_MATERIAL takes part in HAS_ROW. */
#ifndef GRADUS_STAGES_SHADE_VERTEX_H
#define GRADUS_STAGES_SHADE_VERTEX_H
//! traits: TRAIT_REFRACTION TRAIT_LIGHT_TREE SAMPLES_LIGHTS
#include "kernels/lib/bsdf.h"
#include "kernels/lib/bsdf_frame.h"
#include "kernels/lib/camera_way.h"
#include "kernels/lib/light_sampling.h"
#include "kernels/lib/mis.h"
#include "kernels/lib/path_draw.h"
#include "kernels/lib/seen_features.h"
#include "kernels/lib/surface_point.h"
#include "kernels/lib/textured_material.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/stage.h"

STAGE shade(
    uint count, uint unit, uint first, uint to, uint capacity, uint max_depth, uint roulette_depth,
    __global const uint *index, __global const real *path_old, __global real *path, __global const real *ray_old,
    __global real *ray, __global real *shadow, __global const real *triangles, __global const real *triangle_normals,
    __global const real *triangle_tangents, __global const real *spheres, uint triangle_count,
    __global const uint *primitive_material, __global const uint *material_back, __global const real *materials,
    __global const real *lights, __global const uint *light_kinds, __global const uint *light_alias, uint light_count,
    real scene_diameter ENVIRONMENT_PARAMETERS LIGHT_TEXTURE_PARAMETERS LIGHT_CHOICE_PARAMETERS MATERIAL_PARAMETERS
#if TRAIT_AOV
    ,
    __global real *feature, uint slots CAMERA_WAY_ARGUMENT
#endif
#if WITH_OFFSETS
    ,
    __global real *vertex, __global real *event, __global const uint *material_kind
#endif
) {
    const size_t i = work_item();
#if SAMPLES_LIGHTS && !BSDF_IS_DIRAC
    const uint kept = BITS_OF_LIGHTS BITS_OF_LIGHT_TEXTURES;
#else
    const uint kept = 0u;
#endif
    if (!HAS_ROW(i, count, kept | BITS_OF_MATERIAL))
        return;
    const int old = AT_INDEX(first + i);
    const size_t row = to + i;
    const vec3 from = AT_V3_IN(ray_old, ray, origin, old), direction = AT_V3_IN(ray_old, ray, direction, old);
    const uint key_0 = AT_UINT_IN(path_old, path, key_0, old), key_1 = AT_UINT_IN(path_old, path, key_1, old);
    const uint depth = AT_UINT_IN(path_old, path, depth, old), slot = AT_UINT_IN(path_old, path, slot, old);
    const rgb throughput = AT_RGB_IN(path_old, path, throughput, old);
#if TRAIT_REFRACTION
    const real eta_before = AT_IN(path_old, path, eta, old);
#endif
    const uint primitive = AT_UINT_IN(ray_old, ray, primitive, old);
    const primitive_hit hit = primitive_hit_of(triangles, spheres, unit, triangle_count,
                                               primitive INSTANCE_IN(ray_old, ray, old), from, direction);
    const surface_point point =
        CHOSEN_POINT(surface_point_at(triangles, triangle_normals, triangle_tangents, spheres, unit, triangle_count,
                                      primitive_material, material_back, primitive, hit, direction),
                     capacity, old);
    const material m = MATERIAL_AT(point, primitive, hit);
    const bsdf_frame place = HIT_FRAME(point, m, v3_neg(direction), capacity, old);
    const frame axes = place.axes;
    const vec3 wi = frame_to_local(axes, v3_neg(direction));
    const int goes_on = depth + 1u < max_depth;

#if TRAIT_AOV
    const rgb albedo = PASTE(BSDF, _albedo)(m);
    const real from_last = r_sqrt(v3_length_squared(v3_sub(point.position, from))) + WAY_BEFORE(depth, direction);
    SET_SEEN_FEATURES(slot, depth, BSDF_IS_DIRAC, from_last, throughput, albedo, axes.n)
#endif
#if WITH_OFFSETS
    SET_SURFACE_VERTEX(vertex, row, material_kind[point.material], point, direction)
    SET_VERTEX_TEXTURED(vertex, row, capacity, old)
#endif

#if SAMPLES_LIGHTS && !BSDF_IS_DIRAC
    const random4 l = PATH_DRAW(key_0, key_1, random_dimension_light(depth));
#if TRAIT_LIGHT_TREE
    const uint receives = light_normal_bits(point.geometric);
    const light_receiver place_of_light = LIGHT_RECEIVER(point.position, receives, R(0));
    const light_picked picked = light_tree_pick(light_nodes, light_leaves, light_slots, TRAIT_LIGHT_TREE, unit,
                                                light_share_at_infinity, place_of_light, l.a, l.b);
    AT_UINT(path, receiver, row) = receives;
#endif
    const chosen_light chosen =
        light_sampling(lights, light_kinds, light_alias, light_count, scene_diameter, unit, point.position,
                       l ENVIRONMENT_ARGUMENTS LIGHT_TEXTURE_ARGUMENTS LIGHT_PICKED_ARGUMENT);
    const light_choice light = chosen.choice;
    const vec3 to_light = frame_to_local(axes, light.direction);
    const bsdf_value f = MAPPED_VALUE(place, PASTE(BSDF, _evaluate)(m, wi, to_light, transport_radiance), to_light);
#if WITH_OFFSETS
    const rgb arriving = rgb_scale(light.value, goes_on ? R(1) / chosen.probability : R(0));
    const real light_pdf = light.pdf * chosen.probability;
    /* Point lights and directions have no density that BSDF sampling could match. */
    const real inverse_light_pdf = LIGHT_CAN_BE_FOUND && light_pdf > R(0) ? R(1) / light_pdf : R(0);
    const rgb gain = rgb_mul(rgb_mul(throughput, arriving), f.value);
    /* Who sees the light weighs the offset paths, whatever the base path gains. */
    const int asks = goes_on && (rgb_max(gain) > R(0) || rgb_max(arriving) * f.pdf > R(0));
    SET_V3(event, to_light, row, light.direction);
#if TRAIT_LIGHT_TREE
    AT_UINT(event, light, row) = chosen.light;
    AT(event, light_path, row) = picked.path;
#endif
    SET_RGB(event, arriving, row, arriving);
    AT(event, inverse_light_pdf, row) = inverse_light_pdf;
    AT(event, base_bsdf, row) = f.pdf * inverse_light_pdf;
#else
    const real weight = mis_weight_light(light.pdf * chosen.probability, f.pdf) / chosen.probability;
    const rgb gain = rgb_scale(rgb_mul(rgb_mul(throughput, light.value), f.value), weight);
    const int asks = goes_on && rgb_max(gain) > R(0);
#endif
    const vec3 start = ray_origin(point.position, point.geometric, point.offset, light.direction);
    const vec3 light_point = v3_add(point.position, light.connection);
    const vec3 end =
        connection_end(light_point, light.normal,
                       offset_at(light_point, light.normal, LIGHT_FIELD(chosen.light, offset)), light.connection);
    SET_V3(shadow, origin, row, start);
    SET_V3(shadow, direction, row, v3_sub(end, start));
    SET_RGB(shadow, value, row, gain);
    AT_UINT(shadow, open, row) = asks ? 1u : 0u;
#else
    AT_UINT(shadow, open, row) = 0u;
#if WITH_OFFSETS
    SET_RGB(event, arriving, row, rgb_gray(R(0)));
    AT(event, inverse_light_pdf, row) = R(0);
    AT(event, base_bsdf, row) = R(0);
#if TRAIT_LIGHT_TREE
    AT_UINT(event, light, row) = 0u;
    AT(event, light_path, row) = R(1);
#endif
#endif
#endif

    const random4 u = PATH_DRAW(key_0, key_1, random_dimension_scatter(depth));
    const bsdf_sample sampled = PASTE(BSDF, _sample)(m, wi, u.a, u.b, u.c, transport_radiance);
    const bsdf_sample s = MAPPED_SAMPLE(place, sampled);
    const rgb scattered = rgb_mul(throughput, s.weight);
    real eta = R(1);
#if TRAIT_REFRACTION
    eta = eta_before * s.eta;
    AT(path, eta, row) = eta;
#endif
    const int can_go_on = goes_on && s.pdf > R(0);
#if WITH_OFFSETS
    /* For the camera's features, too, `join` knows of roulette; interfaces choose by their share of the light. */
    const int alive = can_go_on;
    const rgb left = scattered;
    AT(event, pdf, row) = s.pdf;
#if BSDF_IS_DIRAC || BSDF_IS_MIXED
    SET_RGB(event, weight, row, s.weight); /* of others `join` knows it */
#endif
#else
    /* Mitsuba's rule: survive with the largest throughput, freed of the radiance scaling by eta^2, at most 0.95. */
    const real survival = depth + 1u >= roulette_depth ? r_min(rgb_max(scattered) * eta * eta, R(0.95)) : R(1);
    const int alive = can_go_on && rgb_max(scattered) > R(0) && u.d < survival;
    const rgb left = rgb_scale(scattered, R(1) / (alive ? survival : R(1)));
#if TRAIT_AOV == 2 && BSDF_IS_DIRAC
    SCALE_SEEN_WEIGHT(slot, s.lobe_weight * seen_by_roulette(can_go_on && rgb_max(scattered) > R(0), alive, survival))
#endif
#endif

    const vec3 next = v3_normalize(frame_to_world(axes, s.wo));
    const vec3 origin = ray_origin(point.position, point.geometric, point.offset, next);
    AT_UINT(path, slot, row) = slot;
    AT_UINT(path, key_0, row) = key_0;
    AT_UINT(path, key_1, row) = key_1;
    AT_UINT(path, depth, row) = depth + 1u;
    SET_RGB(path, throughput, row, left);
    AT(path, pdf, row) = s.is_specular ? R(0) : s.pdf;
    SET_V3(ray, origin, row, origin);
    SET_V3(ray, direction, row, next);
    AT_UINT(ray, primitive, row) = alive ? ray_pending : ray_none;
}

#endif
