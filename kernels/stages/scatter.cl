/* scatter: the surface that each light path met, of one BSDF kind: the photon that it leaves there, and the direction
 * in which it goes on. Light paths at places `first` on of `index` take rows `to` on of `light_path` and `ray`; kinds
 * that are not Dirac write rows `to_photon` on of `photon` and `photon_origin`, with no ordinal where there is no
 * photon. LEAVES_PHOTONS 0: none do.
 *
 * Of a blend any part keeps photons, also a Dirac one, where one of them gathers: the light path draws a part to go on
 * by, the camera path draws another one, and the light that comes to the surface is all there for that.
 *
 * Power is scaled as importance's adjoint is: no squared index where light is refracted, but the ratio of shading and
 * geometric cosines on both sides (Veach 1997, eq. 5.19), since what a shading normal turns is the BSDF and not the
 * surface. A BSDF's sample has f |wo.ns| over its density; the path's power changes by f |wi.ns| / |wi.ng| |wo.ng|.
 *
 * Russian roulette goes by the power against that of the light path's beginning, so that photons are alike.
 *
 * TRAIT_LIGHT_VERTICES: leaves a record of each vertex, from `to_vertex` on, for who shifts photons.
 *
 * TRAIT_TEXTURED_NORMALS: a turned normal goes by who looks, and that is where the light path goes. So it takes either
 * of the two normals, the other one as often as it is tilted, and the sample counts where that is the one seen.
 *
 * TRAIT_ONLY_CHAINS: leaves a photon only where the vertex before is too smooth to gather at. */
//! traits: TRAIT_SHADING_NORMALS TRAIT_ANISOTROPIC TRAIT_LIGHT_VERTICES TRAIT_ONLY_CHAINS TRAIT_TEXTURED_NORMALS
//! traits: TRAIT_TEXTURED TRAIT_MIXED_LOBES TRAIT_BLENDS
#include "kernels/lib/bsdf.h"
#include "kernels/lib/bsdf_frame.h"
#include "kernels/lib/random.h"
#include "kernels/lib/surface_point.h"
#include "kernels/lib/textured_material.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/light_vertex.h"
#include "kernels/shared/stage.h"

STAGE scatter(uint count, uint unit, uint first, uint to, uint capacity, uint max_depth, uint light_roulette_depth,
              __global const uint *index, __global const real *light_path_old, __global real *light_path,
              __global const real *ray_old, __global real *ray, __global const real *triangles,
              __global const real *triangle_normals, __global const real *triangle_tangents,
              __global const real *spheres, uint triangle_count, __global const uint *primitive_material,
              __global const uint *material_back, __global const real *materials SURFACE_ARGUMENT
#if LEAVES_PHOTONS && (!BSDF_IS_DIRAC || TRAIT_BLENDS)
              ,
              __global const uint *material_keeps, __global real *photon, __global real *photon_origin,
              __global uint *photon_place, uint to_photon, uint photon_rows
#endif
#if TRAIT_LIGHT_VERTICES
              ,
              __global real *light_vertices, __global uint *light_vertex_marks, uint to_vertex
#if LIGHT_VERTICES_HAVE_TEXTURES
              ,
              __global real *light_vertex_textures
#endif
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const int old = AT_INDEX(first + i);
    const size_t row = to + i;
    const vec3 from = AT_V3_IN(ray_old, ray, origin, old), direction = AT_V3_IN(ray_old, ray, direction, old);
    const int slot = AT_ROW_IN(light_path_old, light_path, slot, old);
    const uint key_0 = AT_UINT_IN(light_path_old, light_path, key_0, old);
    const uint key_1 = AT_UINT_IN(light_path_old, light_path, key_1, old);
    const uint before = AT_UINT_IN(light_path_old, light_path, depth, old);
    const uint left_before = AT_UINT_IN(light_path_old, light_path, stored, old);
    const rgb arriving = AT_RGB_IN(light_path_old, light_path, power, old);
    const real beginning = AT_IN(light_path_old, light_path, start, old);
    const surface_point point = CHOSEN_POINT(
        surface_point_of(triangles, triangle_normals, triangle_tangents, spheres, unit, triangle_count,
                         primitive_material, material_back,
                         AT_UINT_IN(ray_old, ray, primitive, old) INSTANCE_IN(ray_old, ray, old), from, direction),
        capacity, old);
    const material m = HIT_MATERIAL(point.material, capacity, old);
#if TRAIT_TEXTURED_NORMALS
    const mapped_normal map = mapped_normal_at(surface, capacity, old);
    const real turned_chance = mapped_normal_turned_chance(map, point.shading);
    const int is_turned = random_draw(key_0, key_1, random_dimension_normal(before)).a < turned_chance;
    const vec3 turned_normal = mapped_normal_turned(point.shading, map.normal);
    const vec3 taken_normal = v3_select(is_turned, turned_normal, map.normal);
    const vec3 normal = v3_select(map.flags != 0u, taken_normal, point.shading);
    const bsdf_frame place = bsdf_frame_around(normal, point.shading, point.along, map.flags, m);
    const frame axes = place.axes;
    const real front = v3_dot(point.shading, v3_neg(direction));
#else
    const frame axes = surface_frame(point.shading, point.along, m);
#endif
    const vec3 wi = frame_to_local(axes, v3_neg(direction));
#if !TRAIT_TEXTURED_NORMALS
    const real front = wi.z;
#endif
    const uint edges = before + 1u;
#if TRAIT_LIGHT_VERTICES
    const uint vertex_before = AT_UINT_IN(light_path_old, light_path, vertex, old);
#endif

    uint left = left_before;
#if LEAVES_PHOTONS && (!BSDF_IS_DIRAC || TRAIT_BLENDS)
    const uint gathers = material_keeps[point.material];
    const int is_kept = (gathers == gathers_around) | ((gathers == gathers_in_front) & (front > R(0)));
#if TRAIT_ONLY_CHAINS
    const int is_after_one = vertex_before != light_vertex_none;
    const uint last = FIELD_OF(light_vertex_mark, light_vertex_marks, is_after_one ? vertex_before : 0u, material);
    const int is_after_surface = is_after_one & !light_vertex_is_light(last);
    const int is_photon =
        is_kept & is_after_surface & (material_keeps[is_after_surface ? last : 0u] == gathers_nowhere);
#else
    const int is_photon = is_kept;
#endif
    const size_t photon_row = to_photon + i;
    SET_V3(photon, position, photon_row, point.position);
    SET_V3(photon, wi, photon_row, v3_neg(direction));
    SET_RGB(photon, power, photon_row, arriving);
    SET_V3(photon, normal, photon_row, point.geometric);
    AT_UINT(photon_origin, slot, photon_row) = slot;
    AT_UINT(photon, depth, photon_row) = edges;
#if TRAIT_LIGHT_VERTICES
    AT_UINT(photon, before, photon_row) = vertex_before;
#endif
    AT_UINT(photon_origin, ordinal, photon_row) = is_photon ? left_before : photon_none;
    left += is_photon ? 1u : 0u;
    photon_place[slot] = left;
#endif

    const random4 u = random_draw(key_0, key_1, random_dimension_scatter(before));
    const bsdf_sample sampled = PASTE(BSDF, _sample)(m, wi, u.a, u.b, u.c, transport_importance);
    const vec3 next = v3_normalize(frame_to_world(axes, sampled.wo));
#if TRAIT_TEXTURED_NORMALS
    const int is_seen = (mapped_normal_turns(map, point.shading, next) == is_turned) &
                        mapped_normal_lets_leave(map, point.shading, next);
    const real chance = is_turned ? turned_chance : R(1) - turned_chance;
    const bsdf_sample s = mapped_sample(sampled, is_seen ? mapped_factor(place.flags, place.own, wi) / chance : R(0));
#else
    const real chance = R(1);
    const bsdf_sample s = sampled;
#endif
    real turned = R(1);
#if TRAIT_SHADING_NORMALS || TRAIT_TEXTURED_NORMALS
    const real cosines = r_abs(v3_dot(point.geometric, direction) * s.wo.z);
    turned = r_abs(wi.z * v3_dot(point.geometric, next)) / r_max(cosines, R(1e-12));
#endif
    const rgb scattered = rgb_mul(arriving, rgb_scale(s.weight, turned));
    const real survival = edges >= light_roulette_depth ? r_min(rgb_max(scattered) / beginning, R(0.95)) : R(1);
    /* One edge more, and at least one to the camera. */
    const int alive = edges + 2u <= max_depth && s.pdf > R(0) && rgb_max(scattered) > R(0) && u.d < survival;
    const rgb goes_on = rgb_scale(scattered, R(1) / (alive ? survival : R(1)));
    const vec3 origin = ray_origin(point.position, point.geometric, point.offset, next);
#if TRAIT_LIGHT_VERTICES
    const uint record = to_vertex + (uint)i;
    SET_FIELD_V3(light_vertex, light_vertices, record, position, point.position);
    SET_FIELD_V3(light_vertex, light_vertices, record, geometric, point.geometric);
    const vec3 back = v3_neg(direction);
    SET_FIELD_V3(light_vertex, light_vertices, record, wi, back);
    FIELD_OF(light_vertex, light_vertices, record, power_r) = arriving.r;
    FIELD_OF(light_vertex, light_vertices, record, power_g) = arriving.g;
    FIELD_OF(light_vertex, light_vertices, record, power_b) = arriving.b;
    FIELD_OF(light_vertex, light_vertices, record, offset) = point.offset;
    FIELD_OF(light_vertex, light_vertices, record, pdf) = s.pdf * chance;
    FIELD_OF(light_vertex, light_vertices, record, survival) = survival;
#if TRAIT_SHADING_NORMALS || TRAIT_ANISOTROPIC
    SET_FIELD_V3(light_vertex, light_vertices, record, shading, point.shading);
#endif
#if TRAIT_ANISOTROPIC
    SET_FIELD_V3(light_vertex, light_vertices, record, along, point.along);
#endif
    FIELD_OF(light_vertex_mark, light_vertex_marks, record, material) = point.material;
    FIELD_OF(light_vertex_mark, light_vertex_marks, record, primitive) = AT_UINT_IN(ray_old, ray, primitive, old);
    FIELD_OF(light_vertex_mark, light_vertex_marks, record, before) = vertex_before;
#if TRAIT_MIXED_LOBES
#if BSDF_IS_MIXED
    FIELD_OF(light_vertex_mark, light_vertex_marks, record, mirrors) = s.is_specular ? 1u : 0u;
#else
    FIELD_OF(light_vertex_mark, light_vertex_marks, record, mirrors) = 0u;
#endif
#endif
#if LIGHT_VERTICES_HAVE_TEXTURES
#pragma unroll
    for (uint c = 0; c < (uint)textured_columns; ++c)
        (light_vertex_textures + c * (size_t)unit)[record * (uint)textured_columns] =
            surface[(size_t)c * capacity + old];
#endif
    AT_UINT(light_path, vertex, row) = record;
#endif
    AT_UINT(light_path, slot, row) = slot;
    AT_UINT(light_path, key_0, row) = key_0;
    AT_UINT(light_path, key_1, row) = key_1;
    AT_UINT(light_path, depth, row) = edges;
    AT_UINT(light_path, stored, row) = left;
    SET_RGB(light_path, power, row, goes_on);
    AT(light_path, start, row) = beginning;
    SET_V3(ray, origin, row, origin);
    SET_V3(ray, direction, row, next);
    AT_UINT(ray, primitive, row) = alive ? ray_pending : ray_none;
}
