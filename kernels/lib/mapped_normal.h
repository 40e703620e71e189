/* Normals that textures turn, as Mitsuba 3.9 has them: a BSDF stands in the frame of the turned normal, whatever the
 * surface's own is.
 *
 * Light counts only where it is on the same side by both normals. Two more rules are flags of a material. Where the
 * turned normal would be seen from another side than the surface's own (normal_map_turns), it is turned about the own
 * one by half a turn (Schuessler et al. 2017, section 3): so which normal a vertex has goes by who looks. And light
 * that grazes the surface is dimmed (normal_map_shadows), as if by microfacets (Conty Estevez et al. 2019), so that it
 * does not end at an edge. Directions: wi is the camera's side, wo the light's, whichever way a path goes. */
#ifndef GRADUS_LIB_MAPPED_NORMAL_H
#define GRADUS_LIB_MAPPED_NORMAL_H
#include "kernels/lib/frame.h"
#include "kernels/shared/texture.h"

GRADUS_LIB_BEGIN

/* World frame, unit length, on the side from which the surface is seen; flags: those of normal_map_of_vertex. */
typedef struct {
    vec3 normal;
    uint flags;
    GRADUS_NOT_IN_REGISTERS
} mapped_normal;

/* The other one of the two: half a turn about `own`. */
GRADUS_FN vec3 mapped_normal_turned(vec3 own, vec3 normal) {
    return v3_mad(v3_neg(normal), R(2) * v3_dot(own, normal), own);
}

/* Whether who looks along -wi sees the other one. */
GRADUS_FN int mapped_normal_turns(mapped_normal map, vec3 own, vec3 wi) {
    const real side = v3_dot(wi, own) * v3_dot(wi, map.normal);
    return ((map.flags & normal_map_turns) != 0u) & !(side > R(0));
}

/* The normal that is seen along -wi; without a map the surface's own. */
GRADUS_FN vec3 mapped_normal_seen(mapped_normal map, vec3 own, vec3 wi) {
    const vec3 turned = mapped_normal_turned(own, map.normal);
    const vec3 seen = v3_select(mapped_normal_turns(map, own, wi), turned, map.normal);
    return v3_select(map.flags != 0u, seen, own);
}

/* How likely a light path, which does not know yet who will look, takes the other one: as it is tilted. */
GRADUS_FN real mapped_normal_turned_chance(mapped_normal map, vec3 own) {
    const real aligned = v3_dot(map.normal, own);
    const real tilted = R(0.5) * r_sqrt(r_max(R(1) - aligned * aligned, R(0)));
    return (map.flags & normal_map_turns) != 0u ? tilted : R(0);
}

/* Whether light that came from the side of `own` may leave along `next`: who looks at what is two-sided from behind
 * sees another surface, which that light does not reach. */
GRADUS_FN int mapped_normal_lets_leave(mapped_normal map, vec3 own, vec3 next) {
    return ((map.flags & normal_map_on_two_sided) == 0u) | (v3_dot(own, next) > R(0));
}

/* tan^2 of the angle whose cosine this is; bounded, so that 0 times it is 0. */
GRADUS_FN real tangent_squared(real cosine) {
    const real square = cosine * cosine;
    return r_max(R(1) - square, R(0)) / r_max(square, R(1e-12));
}

/* What a map makes of light from wo, a factor on the BSDF's value: 0 where it is on different sides of the two normals.
 * `own` is the surface's normal and wo the direction in the frame of the mapped one. */
GRADUS_FN real mapped_factor(uint flags, vec3 own, vec3 wo) {
    const real cosine = v3_dot(own, wo);
    /* Conty Estevez et al. 2019, listing 12-1: the roughness squared, then the shadowing of GGX. */
    const real roughness = r_min(R(0.125) * tangent_squared(own.z), R(1));
    const real shadowing = R(2) / (R(1) + r_sqrt(R(1) + roughness * tangent_squared(cosine)));
    const real factor = (flags & normal_map_shadows) != 0u ? shadowing : R(1);
    const int is_on_both = cosine * wo.z > R(0);
    return flags == 0u || is_on_both ? factor : R(0);
}

GRADUS_LIB_END
#endif
