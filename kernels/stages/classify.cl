/* classify: says for each traced ray which bin its path goes to next: bin 0 for those that escaped, one bin for each
 * BSDF kind of the scene, and bin_none for paths that have ended. */
//! traits: TRAIT_ENVIRONMENT TRAIT_TWO_FACED TRAIT_SPHERES TRAIT_TRIANGLES TRAIT_MANY_BSDF_KINDS
#include "kernels/lib/scene_hit.h"
#include "kernels/shared/stage.h"

STAGE classify(uint count, uint unit, uint capacity, __global const real *ray, __global uint *bin,
               __global const uint *primitive_material, __global const uint *material_bin,
               __global const uint *material_flags, __global const uint *material_back,
               __global const real *triangles, __global const real *spheres, uint triangle_count) {
    const size_t row = get_global_id(0);
    if (row >= count)
        return;
    const uint primitive = AT_UINT(ray, primitive, row);
    const int hit = primitive < ray_first_special;
#if TRAIT_MANY_BSDF_KINDS
    uint material = primitive_material[hit ? primitive : 0u];
#if TRAIT_TWO_FACED
    /* The two sides may be of different kinds. */
    const vec3 direction = AT_V3(ray, direction, row);
    const int behind = primitive_is_behind(triangles, spheres, unit, triangle_count, hit ? primitive : 0u,
                                           AT_V3(ray, origin, row), direction);
    material = behind && (material_flags[material] & material_flag_two_sided) ? material_back[material] : material;
#endif
    const uint hit_bin = material_bin[material];
#else
    const uint hit_bin = 1u;
#endif
#if TRAIT_ENVIRONMENT
    const uint escaped_bin = primitive == ray_escaped ? 0u : bin_none;
#else
    const uint escaped_bin = bin_none;
#endif
    bin[row] = hit ? hit_bin : escaped_bin;
}
