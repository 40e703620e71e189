/* With which probability a smooth interface reflects a path. */
#ifndef GRADUS_LIB_LOBE_CHANCE_H
#define GRADUS_LIB_LOBE_CHANCE_H
//! traits: TRAIT_LOBE_LEVELS
#include "kernels/shared/compat.h"

GRADUS_LIB_BEGIN

/* A level near the reflectance, where the choice is stratified over the samples of a pixel: of 8 samples an eighth,
 * a quarter, a half... reflect, exactly, so that the choice has no noise at all; and neighbouring pixels, whose paths
 * take the same numbers, make the same choice. Glass that reflects a twenty-fifth does so with every eighth sample:
 * what is seen in it is often far brighter than what is seen through it. Each lobe is weighted by its share over its
 * probability, at most one and a half. Where nearly all or nothing is reflected the other lobe
 * keeps the chance that it has, and is not stratified. */
GRADUS_FN real level_near(real reflectance) {
    /* A sum: nested choices would become a switch (docs/design.md). */
    const real level = R(0.125) + (reflectance > R(0.1875) ? R(0.125) : R(0)) +
                       (reflectance > R(0.375) ? R(0.25) : R(0)) + (reflectance > R(0.625) ? R(0.25) : R(0)) +
                       (reflectance > R(0.8125) ? R(0.125) : R(0));
    const int has_both = (reflectance > R(0.005)) & (reflectance < R(0.995));
    return has_both ? level : reflectance;
}

/* is_from_camera: the path is, and so one of those that may be stratified (kernels/lib/path_draw.h). */
GRADUS_FN real reflection_chance(real reflectance, int is_from_camera) {
#if TRAIT_LOBE_LEVELS
    return is_from_camera ? level_near(reflectance) : reflectance;
#else
    (void)is_from_camera;
    return reflectance;
#endif
}

/* Of a lobe that takes this share of the light. */
GRADUS_FN real lobe_weight(real share, real chance) { return share == chance ? R(1) : share / r_max(chance, R(1e-6)); }

GRADUS_LIB_END
#endif
