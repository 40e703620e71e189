/* emission: adds the light that a path finds at an emitting surface, weighted against light sampling: rows
 * index[first] on. Runs before `shade`.
 *
 * DIRECT_APART: what the camera sees of lights goes to `direct`. */
//! traits: TRAIT_HIDE_EMITTERS TRAIT_LIGHT_TREE
#include "kernels/lib/light_found.h"
#include "kernels/lib/light_tree.h"
#include "kernels/lib/mis.h"
#include "kernels/shared/stage.h"

STAGE emission(uint count, uint unit, uint first, uint capacity, uint slots, __global const uint *index,
               __global const real *ray, __global const real *path, __global real *radiance,
               __global const real *triangles, __global const real *spheres, uint triangle_count,
               __global const uint *primitive_light, __global const real *lights,
               uint light_count LIGHT_TEXTURE_PARAMETERS LIGHT_PROBABILITY_PARAMETERS
#if DIRECT_APART
               ,
               __global real *direct
#endif
) {
    const size_t i = work_item();
#if LIGHTS_HAVE_SURFACE_TEXTURES
    if (!HAS_ROW(i, count, texture_bits(TRAIT_LIGHT_TEXTURES, 0u, textures, texture_reals, unit)))
#else
    if (i >= count)
#endif
        return;
    const int row = AT_INDEX(first + i);
    const int slot = AT_ROW(path, slot, row);
    const uint primitive = AT_UINT(ray, primitive, row);
    const vec3 origin = AT_V3(ray, origin, row);
    const vec3 direction = AT_V3(ray, direction, row);
    const primitive_hit hit = primitive_hit_of(triangles, spheres, unit, triangle_count,
                                               primitive INSTANCE_IN(ray, ray, row), origin, direction);
    const light_found found = light_found_at(primitive_light, lights, light_count, unit, triangle_count, primitive, hit,
                                             origin, direction LIGHT_TEXTURE_ARGUMENTS);
#if TRAIT_LIGHT_TREE
    const light_receiver place = LIGHT_RECEIVER(origin, AT_UINT(path, receiver, row), R(0));
    const real light_pdf =
        found.pdf * light_tree_path(light_nodes, TRAIT_LIGHT_TREE, unit, light_leaf[(int)found.light], place);
#else
    const real light_pdf = found.pdf;
#endif
    real weight = mis_weight_bsdf(AT(path, pdf, row), light_pdf);
#if TRAIT_HIDE_EMITTERS
    weight = AT_UINT(path, depth, row) > 0u ? weight : R(0);
#endif
    const rgb throughput = AT_RGB(path, throughput, row);
    const rgb gained = rgb_mul(rgb_scale(found.radiance, weight), throughput);
#if DIRECT_APART
    const int is_seen = AT_UINT(path, depth, row) == 0u;
    const rgb seen = rgb_add(AT_RGB_IN(direct, radiance, value, slot), rgb_select(is_seen, gained, rgb_gray(R(0))));
    SET_RGB_IN(direct, radiance, value, slot, seen);
    const rgb later = rgb_select(is_seen, rgb_gray(R(0)), gained);
    ADD_RGB(radiance, value, slot, later);
#else
    ADD_RGB(radiance, value, slot, gained);
#endif
}
