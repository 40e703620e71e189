/* Features: what the camera sees beside light, for whoever filters the image. They are of the first surface that is no
 * perfect mirror, glass or hole: through these one sees what lies behind, and its edges and textures are the image's.
 * Albedo is times what mirrors and glass let pass, depth is the length of the way.
 *
 * TRAIT_AOV: 1 where the scene has no such surface, else 2. Then, as long as a path has met nothing else, its depth is
 * minus the way so far, and the rest is of the first surface: a chain that ends so, in the sky say, shows that. */
#ifndef GRADUS_LIB_SEEN_FEATURES_H
#define GRADUS_LIB_SEEN_FEATURES_H
//! traits: TRAIT_AOV
#include "kernels/lib/vector.h"

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
                const rgb through = rgb_mul(albedo_here, passed);                                                      \
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
