/* classify: says for each traced ray which bin its path goes to next. Bin 0 is for those that escaped; BSDF kind k of
 * the scene has bin 1 + 2 k, and the next one for surfaces that also emit; bin_none drops paths that have ended.
 *
 * With PHASES, vertices are also kept apart by what becomes of offset paths there (gradient_path_tracer.h): first ones,
 * with TRAIT_APART then those where some are apart, then those where the last have reconnected, later ones. Bins 0 to
 * PHASES - 1 are for those that escaped, and bin b > 0 of phase p becomes PHASES - 1 + p (bins_of_phase - 1) + b. */
//! traits: TRAIT_ENVIRONMENT TRAIT_TWO_FACED TRAIT_APART TRAIT_SHIFT_DISTANCE
#include "kernels/lib/reconnectable.h"
#include "kernels/lib/scene_hit.h"
#include "kernels/shared/stage.h"

#ifdef PHASES
#define PHASE_JOINED (PHASES - 2u)
#define PHASE_LATER (PHASES - 1u)
#endif

STAGE classify(uint count, uint unit, uint capacity, __global const real *ray, __global uint *bin,
               __global const uint *primitive_bin, __global const uint *primitive_back_bin,
               __global const real *triangles, __global const real *spheres, uint triangle_count
#ifdef PHASES
               ,
               uint bins_of_phase, uint shifting, uint fresh
#if TRAIT_APART
               ,
               __global const uint *offset_state, __global const uint *primitive_material,
               __global const uint *primitive_light, __global const uint *material_back,
               __global const uint *material_kind
#if TRAIT_SHIFT_DISTANCE
               ,
               __global const real *vertex, __global const real *offset_reach
#endif
#endif
#endif
) {
    const size_t row = work_item();
    if (row >= count)
        return;
    const uint primitive = AT_UINT(ray, primitive, row);
    const int hit = primitive < ray_first_special;
    const uint present = hit ? primitive : 0u;
    uint hit_bin = primitive_bin[present];
    int behind = 0;
#if TRAIT_TWO_FACED
    /* The two sides may be of different kinds. */
    behind = primitive_is_behind(triangles, spheres, unit, triangle_count, present, AT_V3(ray, origin, row),
                                 AT_V3(ray, direction, row));
    const uint back_bin = primitive_back_bin[present];
    hit_bin = behind ? back_bin : hit_bin;
#endif
    uint phase = 0u;
#ifdef PHASES
    /* Rows below `shifting` have offset paths of their own, those from `fresh` on begin. */
    phase = row < shifting ? PHASE_JOINED : PHASE_LATER;
#if TRAIT_APART
    const uint state = offset_state[row < shifting ? row : 0u];
    const uint kind = kind_of_primitive(primitive_material, material_back, material_kind, present, behind);
    int reconnectable = !hit | is_reconnectable(kind, primitive_light[present]);
#if TRAIT_SHIFT_DISTANCE
    const vec3 next = primitive_hit_of(triangles, spheres, unit, triangle_count, present, AT_V3(ray, origin, row),
                                       AT_V3(ray, direction, row))
                          .position;
    const vec3 way = v3_sub(next, AT_V3(vertex, position, row));
    const real reach = offset_reach[row < shifting ? row : 0u];
    reconnectable &= !hit | (primitive_light[present] != no_light) | (v3_dot(way, way) >= reach * reach);
#endif
    const int stay_apart = (state == offset_mixed) | ((state == offset_rough) & !reconnectable);
    phase = row < shifting && stay_apart ? 1u : phase;
#endif
    phase = row >= fresh ? 0u : phase;
    hit_bin += PHASES - 1u + phase * (bins_of_phase - 1u);
#endif
#if TRAIT_ENVIRONMENT
    const uint escaped_bin = primitive == ray_escaped ? phase : bin_none;
#elif defined(PHASES)
    /* Nothing is there to be found, but the sums of those that begin must. */
    const uint escaped_bin = row >= fresh && primitive == ray_escaped ? 0u : bin_none;
#else
    const uint escaped_bin = bin_none;
#endif
    bin[row] = hit ? hit_bin : escaped_bin;
}
