/* classify: says for each traced ray which bin its path goes to next (BinLayout in runtime/wavefront/wavefront.h).
 * bin_none drops paths that have ended.
 *
 * GATHER: paths that meet a surface that is rough enough leave a gather point there, which is phase 1. Rows in
 * [gathered_first, gathered_end) have left one: they end with the light that they find, if any (photon_mapper.h).
 *
 * FRESH_APART: rows from `fresh` on, which begin, are phase 1.
 *
 * TRAIT_GRADIENT: rows below `shifting` have offset paths that are not connected, rows from `fresh` on begin; where
 * offset paths are at the next vertex decides the phase (gradient_path_tracer.h). */
//! traits: TRAIT_ENVIRONMENT TRAIT_TWO_FACED TRAIT_GRADIENT TRAIT_APART
#include "kernels/lib/gradient.h"
#include "kernels/lib/material_side.h"
#include "kernels/lib/surface_side.h"
#include "kernels/lib/textured_material.h"
#include "kernels/shared/stage.h"

STAGE classify(uint count, uint unit, uint capacity, __global const real *ray, __global uint *bin,
               __global const uint *primitive_bin
#if TRAIT_BLENDS
               ,
               __global const real *surface, __global const uint *record_kind, uint blend_bin
#endif
#if TRAIT_TWO_FACED
               ,
               __global const uint *primitive_back_bin, __global const real *triangles,
               __global const real *triangle_normals, __global const real *spheres, uint triangle_count
#endif
#if GATHER
               ,
               uint bins_of_phase, uint gathered_first, uint gathered_end, __global const uint *primitive_material,
               __global const uint *material_back, __global const uint *material_gathers
#endif
#if FRESH_APART
               ,
               uint bins_of_phase, uint fresh
#endif
#if TRAIT_GRADIENT
               ,
               uint bins_of_phase, uint shifting, uint fresh
#if MIXED
               ,
               uint slots, __global const real *path, __global const real *primary_vertex, uint primary_shift,
               STRIP_PLACE
#endif
#if TRAIT_APART
               ,
               __global const uint *offsets_state
#endif
#endif
) {
    const size_t row = work_item();
    if (row >= count)
        return;
    const uint primitive = AT_UINT(ray, primitive, row);
    const int hit = primitive < ray_first_special;
    const uint present = hit ? primitive : 0u;
    uint hit_bin = OF_PRIMITIVE(primitive_bin, bin, present);
#if TRAIT_TWO_FACED
    /* The two sides may be of different kinds. */
    const int behind =
        primitive_is_behind(triangles, triangle_normals, spheres, unit, triangle_count,
                            present INSTANCE_IN(ray, ray, row), AT_V3(ray, origin, row), AT_V3(ray, direction, row));
    const uint back_bin = OF_PRIMITIVE(primitive_back_bin, back_bin, present);
    hit_bin = behind ? back_bin : hit_bin;
#endif
#if TRAIT_BLENDS
    /* Of the kind that the blend has come to; whether it emits is as it was. Others have left no record. */
    const int is_blend = hit && hit_bin >= blend_bin;
    const uint chosen = surface_record_at(surface, capacity, row);
    const uint blended_bin = 1u + 2u * record_kind[is_blend ? chosen : 0u] + ((hit_bin - 1u) & 1u);
    hit_bin = is_blend ? blended_bin : hit_bin;
#endif
    uint escaped_bin = 0u;
#if GATHER
    uint record = material_record(OF_PRIMITIVE(primitive_material, material, present));
#if TRAIT_TWO_FACED
    record = material_on_side(material_back, OF_PRIMITIVE(primitive_material, material, present), behind);
#endif
#if TRAIT_BLENDS
    record = is_blend ? chosen : record;
#endif
    const uint gathers = material_gathers[record] != gathers_nowhere ? 1u : 0u;
    const uint emits = (hit_bin & 1u) == 0u ? 1u : 0u;
    const int has_gathered = row >= gathered_first && row < gathered_end;
    const uint onward_bin = hit_bin + 1u + gathers * bins_of_phase;
    hit_bin = has_gathered ? (emits ? FOUND_BIN : bin_none) : onward_bin;
#endif
#if FRESH_APART
    hit_bin += row >= fresh ? bins_of_phase : 0u;
#endif
#if TRAIT_GRADIENT
    const int begins = row >= fresh, shifts = row < shifting;
    uint phase = begins ? PHASE_FIRST : shifts ? PHASE_JOINED : PHASE_LATER;
    escaped_bin = begins ? ESCAPED_FIRST : shifts ? ESCAPED_SHIFTING : ESCAPED_LATER;
#if TRAIT_APART
    const uint offsets = offsets_state[shifts ? row : 0u];
    phase = shifts && offsets_place(offsets) == offsets_alike ? PHASE_APART : phase;
    /* An offset path may find a light where its base path finds none: bins of what emits are the even ones. */
    hit_bin += shifts && (offsets & offsets_meet_light) != 0u ? hit_bin & 1u : 0u;
#endif
#if MIXED
#if TRAIT_APART
    phase = shifts && offsets_place(offsets) == offsets_mixed ? PHASE_APART_MIXED : phase;
#endif
    /* Whether the neighbours see the same BSDF kind. */
    const uint slot = begins ? AT_UINT(path, slot, row) : 0u;
    const film_pixel pixel = PIXEL_OF(slot);
    const uint own_kind = kind_number(AT_UINT(primary_vertex, kind, slot + primary_shift));
    int alike = 1;
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const uint neighbour = gradient_neighbour(slot, j, pixel, crop_width, crop_height) + primary_shift;
        const uint kind = AT_UINT(primary_vertex, kind, neighbour);
        alike &= (kind == kind_none) | (kind_number(kind) == own_kind);
    }
    phase = begins && !alike ? PHASE_FIRST_MIXED : phase;
#endif
    hit_bin += ESCAPED_BINS - 1u + phase * bins_of_phase;
#endif
#if !TRAIT_ENVIRONMENT
    escaped_bin = bin_none; /* nothing is there to be found */
#endif
    const uint other_bin = primitive == ray_escaped ? escaped_bin : bin_none;
    bin[row] = hit ? hit_bin : other_bin;
}
