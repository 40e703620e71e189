/* Multiple importance sampling with the balance heuristic (Veach 1997, eq. 9.8), and the two strategies alone for
 * tests that they agree. */
#ifndef GRADUS_LIB_MIS_H
#define GRADUS_LIB_MIS_H
//! traits: STRATEGY
#include "kernels/shared/compat.h"

#define STRATEGY_MIS 0
#define STRATEGY_LIGHT 1
#define STRATEGY_BSDF 2

/* 0 where BSDF sampling is not to find what light sampling can. */
#define LIGHT_CAN_BE_FOUND (STRATEGY != STRATEGY_LIGHT)

GRADUS_LIB_BEGIN

/* Weight of a light that light sampling chose with density pdf_light; pdf_bsdf is what BSDF sampling would have. */
GRADUS_FN real mis_weight_light(real pdf_light, real pdf_bsdf) {
#if STRATEGY == STRATEGY_LIGHT
    (void)pdf_light, (void)pdf_bsdf;
    return R(1);
#else
    /* As a ratio: the densities' sum could overflow where one is huge. */
    return pdf_light > R(0) ? R(1) / (R(1) + pdf_bsdf / pdf_light) : R(1);
#endif
}

/* Weight of a light that BSDF sampling met with density pdf_bsdf (0: a Dirac direction, or the camera's own ray);
 * pdf_light is what light sampling would have. */
GRADUS_FN real mis_weight_bsdf(real pdf_bsdf, real pdf_light) {
#if STRATEGY == STRATEGY_LIGHT
    (void)pdf_light;
    return pdf_bsdf > R(0) ? R(0) : R(1);
#elif STRATEGY == STRATEGY_BSDF
    (void)pdf_bsdf, (void)pdf_light;
    return R(1);
#else
    return pdf_bsdf > R(0) ? R(1) / (R(1) + pdf_light / pdf_bsdf) : R(1);
#endif
}

/* Weight of a difference that light sampling finds at a vertex to which base and offset path have come from two sides,
 * so that BSDF sampling leaves it for the light with two densities: `base_bsdf`, and `offset_bsdf` times `ratio`, both
 * over that of light sampling, which is the same for both; `ratio` is that of the paths' densities up to the vertex.
 *
 * Light that BSDF sampling finds from there is not weighed by all four samplers: paths have merged, and each weighs it
 * by its own two, then by the ratio of both paths. With b, o and r the above, b' = o / r and the density of light
 * sampling 1, that is b / (1 + b) * b / (b + o) of the base path and b' / (1 + b') * o / (b + o) of the offset path.
 * What they leave of one is light sampling's, as 1 to r:
 *
 *     (b / (1 + b) + o / (1 + b')) / (b + o) / (1 + r),
 *
 * the balance heuristic's 1 / (1 + b + r + o) where b' = b. */
GRADUS_FN real weight_of_light_at_shared_vertex(real base_bsdf, real offset_bsdf, real ratio) {
    /* Bounded, so that sums are finite; what is larger leaves light sampling nothing. */
    const real b = r_min(base_bsdf, R(1e30)), o = r_min(offset_bsdf, R(1e30)), r = r_max(ratio, R(0));
    const real both = b + o;
    const real of_offset = r > R(0) ? o / (R(1) + o / r) : R(0);
    return (both > R(0) ? (b / (R(1) + b) + of_offset) / both : R(1)) / (R(1) + r);
}

GRADUS_LIB_END
#endif
