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

GRADUS_LIB_END
#endif
