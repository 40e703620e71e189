/* classify: says for each traced ray which bin its path goes to next. Bin 0 is for those that escaped; BSDF kind k of
 * the scene has bin 1 + 2 k, and the next one for surfaces that also emit; bin_none drops paths that have ended.
 *
 * With PHASES, paths are also kept apart by how many edges they have: the first, the second, more. Then bins 0 to 2
 * are for those that escaped, and bin b > 0 of phase p becomes 2 + p * (bins_of_phase - 1) + b. */
//! traits: TRAIT_ENVIRONMENT TRAIT_TWO_FACED
#include "kernels/lib/scene_hit.h"
#include "kernels/shared/stage.h"

#ifdef PHASES
#define PHASE_ARGUMENTS , __global const real *vertex_old, uint bins_of_phase
#else
#define PHASE_ARGUMENTS
#endif

STAGE classify(uint count, uint unit, uint capacity, __global const real *ray, __global uint *bin,
               __global const uint *primitive_bin, __global const uint *primitive_back_bin,
               __global const real *triangles, __global const real *spheres, uint triangle_count PHASE_ARGUMENTS) {
    const size_t row = get_global_id(0);
    if (row >= count)
        return;
    const uint primitive = AT_UINT(ray, primitive, row);
    const int hit = primitive < ray_first_special;
    const uint present = hit ? primitive : 0u;
    uint hit_bin = primitive_bin[present];
#if TRAIT_TWO_FACED
    /* The two sides may be of different kinds. */
    const int behind = primitive_is_behind(triangles, spheres, unit, triangle_count, present, AT_V3(ray, origin, row),
                                           AT_V3(ray, direction, row));
    const uint back_bin = primitive_back_bin[present];
    hit_bin = behind ? back_bin : hit_bin;
#endif
    uint phase = 0u;
#ifdef PHASES
    phase = min(AT_UINT_IN(vertex_old, vertex, depth, row), PHASES - 1u);
    hit_bin += PHASES - 1u + phase * (bins_of_phase - 1u);
#endif
#if TRAIT_ENVIRONMENT
    const uint escaped_bin = primitive == ray_escaped ? phase : bin_none;
#else
    const uint escaped_bin = bin_none;
#endif
    bin[row] = hit ? hit_bin : escaped_bin;
}
