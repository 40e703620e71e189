/* Which vertices offset paths may reconnect to, and over which distance. */
#ifndef GRADUS_LIB_RECONNECTABLE_H
#define GRADUS_LIB_RECONNECTABLE_H
//! traits: TRAIT_TWO_FACED
#include "kernels/lib/material_side.h"
#include "kernels/lib/vector.h"
#include "kernels/shared/scene_records.h"
#include "kernels/shared/tables.h"

GRADUS_LIB_BEGIN

/* What a ray finds there: the kind of the material on the side that it comes from. */
GRADUS_FN uint kind_of_primitive(GRADUS_GLOBAL const uint *primitive_material, GRADUS_GLOBAL const uint *material_back,
                                 GRADUS_GLOBAL const uint *material_kind, uint primitive, int is_behind) {
    (void)material_back, (void)is_behind;
#if TRAIT_TWO_FACED
    return material_kind[material_on_side(material_back, OF_PRIMITIVE(primitive_material, material, primitive),
                                          is_behind)];
#else
    return material_kind[material_record(OF_PRIMITIVE(primitive_material, material, primitive))];
#endif
}

/* 1 for rough surfaces, and for those that emit: there paths end, whatever the surface does with light. */
GRADUS_FN int is_reconnectable(uint kind, uint light) { return ((kind & kind_is_rough) != 0u) | (light != no_light); }

/* Over shorter ways offset paths do not reconnect, since both ends would see them from too different directions: the
 * square of that way for base and offset vertices whose distance has this square. It is in proportion to that distance,
 * and so to the size of the pixels, and at most `shift_distance`, for neighbours that see different things. The same
 * for the shift back. */
#define GRADUS_LEAST_WAY R(8) /* over the distance of the two vertices; measured, docs/design.md */
GRADUS_FN real least_way_squared(real separation_squared, real shift_distance) {
    return r_min(GRADUS_LEAST_WAY * GRADUS_LEAST_WAY * separation_squared, shift_distance * shift_distance);
}

/* 1 where the ways from base and offset vertex to `next` are long enough. Ways to a light have no least length: light
 * sampling connects to it all the same. */
GRADUS_FN int is_far(vec3 base, vec3 offset, vec3 next, uint next_light, real shift_distance) {
    const vec3 separation = v3_sub(offset, base), way = v3_sub(next, base), offset_way = v3_sub(next, offset);
    const real least = least_way_squared(v3_dot(separation, separation), shift_distance);
    return (next_light != no_light) | ((v3_dot(way, way) >= least) & (v3_dot(offset_way, offset_way) >= least));
}

GRADUS_LIB_END
#endif
