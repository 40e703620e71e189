/* Features: what the camera sees beside light, for whoever filters the image. They are of the first surface that is no
 * perfect mirror, glass or hole: through these one sees what lies behind, and its edges and textures are the image's.
 * Albedo is times what mirrors and glass let pass, depth is the length of the way.
 *
 * A path is to count by the share of the light that it stands for: who sums features multiplies by `weight`. It makes
 * up for smooth interfaces that choose by other chances (kernels/lib/lobe_chance.h) and for Russian roulette among
 * mirrors and glass: paths that it ends there count for nothing, those that survive for them too. What the chain lets
 * pass is no part of it, and makes the albedo darker, not the path.
 *
 * TRAIT_AOV: 1 where the scene has no such surface, else 2. Then, as long as a path has met nothing else, its depth is
 * minus the way so far, and the rest is of the first surface: a chain that ends so, in the sky say, shows that. */
#ifndef GRADUS_LIB_SEEN_FEATURES_H
#define GRADUS_LIB_SEEN_FEATURES_H
//! traits: TRAIT_AOV
#include "kernels/lib/vector.h"

GRADUS_LIB_BEGIN

/* The factor of `weight` by roulette. A path that ends otherwise, by its length or where all is black, does so whatever
 * roulette says, and counts as it did. */
GRADUS_FN real seen_by_roulette(int could_go_on, int survives, real survival) {
    const real inverse_survival = R(1) / (survives ? survival : R(1));
    return could_go_on && !survives ? R(0) : inverse_survival;
}

GRADUS_LIB_END

#if TRAIT_AOV == 2
#define SEEN_WEIGHT(slot) AT(feature, weight, slot)
/* Of a vertex where the path may be in a chain of mirrors and glass, after SET_SEEN_FEATURES. */
#define SCALE_SEEN_WEIGHT(slot, factor) AT(feature, weight, slot) *= AT(feature, depth, slot) < R(0) ? (factor) : R(1);
#else
#define SEEN_WEIGHT(slot) R(1)
#endif

/* What a path adds to sums of features. Its depth is negative where it has met mirrors and glass alone. */
#define SEEN_ALBEDO(slot) rgb_scale(AT_RGB(feature, albedo, slot), SEEN_WEIGHT(slot))
#define SEEN_NORMAL(slot) v3_scale(AT_V3(feature, normal, slot), SEEN_WEIGHT(slot))
#define SEEN_DEPTH(slot) (r_abs(AT(feature, depth, slot)) * SEEN_WEIGHT(slot))

/* Of a path's vertex; `vertices` are those before it, `from_last` the way from the last one or the camera, and
 * `passed` the throughput so far. */
#if TRAIT_AOV == 2
#define SET_SEEN_FEATURES(slot, vertices, is_dirac, from_last, passed, albedo_here, normal_here)                       \
    {                                                                                                                  \
        const real way_before = AT(feature, depth, slot);                                                              \
        if ((vertices) == 0u || way_before < R(0)) {                                                                   \
            const real way = (from_last)-way_before;                                                                   \
            AT(feature, depth, slot) = (is_dirac) ? -way : way;                                                        \
            if (!(is_dirac) || (vertices) == 0u) {                                                                     \
                const rgb through = rgb_scale(rgb_mul(albedo_here, passed), R(1) / r_max(SEEN_WEIGHT(slot), R(1e-6))); \
                const rgb seen = rgb3(r_min(through.r, R(1)), r_min(through.g, R(1)), r_min(through.b, R(1)));         \
                SET_RGB(feature, albedo, slot, seen);                                                                  \
                SET_V3(feature, normal, slot, normal_here);                                                            \
            }                                                                                                          \
        }                                                                                                              \
    }
#else
#define SET_SEEN_FEATURES(slot, vertices, is_dirac, from_last, passed, albedo_here, normal_here)                       \
    if ((vertices) == 0u) {                                                                                            \
        SET_RGB(feature, albedo, slot, albedo_here);                                                                   \
        SET_V3(feature, normal, slot, normal_here);                                                                    \
        AT(feature, depth, slot) = from_last;                                                                          \
    }
#endif

#endif
