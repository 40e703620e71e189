/* Which vertices offset paths may reconnect to. */
#ifndef GRADUS_LIB_RECONNECTABLE_H
#define GRADUS_LIB_RECONNECTABLE_H
//! traits: TRAIT_TWO_FACED
#include "kernels/shared/scene_records.h"
#include "kernels/shared/tables.h"

GRADUS_LIB_BEGIN

/* What a ray finds there: the kind of the material on the side that it comes from. */
GRADUS_FN uint kind_of_primitive(GRADUS_GLOBAL const uint *primitive_material, GRADUS_GLOBAL const uint *material_back,
                                 GRADUS_GLOBAL const uint *material_kind, uint primitive, int is_behind) {
    const uint sided_material = primitive_material[primitive];
    uint material_index = material_record(sided_material);
    (void)material_back, (void)is_behind;
#if TRAIT_TWO_FACED
    const uint back = material_back[material_index];
    material_index = (sided_material & material_two_sided) != 0u && is_behind ? back : material_index;
#endif
    return material_kind[material_index];
}

/* 1 for rough surfaces, and for those that emit: there paths end, whatever the surface does with light. */
GRADUS_FN int is_reconnectable(uint kind, uint light) { return ((kind & kind_is_rough) != 0u) | (light != no_light); }

GRADUS_LIB_END
#endif
