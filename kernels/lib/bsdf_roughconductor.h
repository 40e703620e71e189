/* A rough conductor, one-sided: f = F D G1(wi) G1(wo) / (4 cos wi cos wo) (Walter et al. 2007, eq. 20), sampled by
 * visible normals: pdf(wo) = D(h) / (4 sigma(wi)), weight = F G1(wo). */
#ifndef GRADUS_LIB_BSDF_ROUGHCONDUCTOR_H
#define GRADUS_LIB_BSDF_ROUGHCONDUCTOR_H
#include "kernels/lib/bsdf_conductor.h"
#include "kernels/lib/microfacet_event.h"

GRADUS_LIB_BEGIN

GRADUS_FN bsdf_terms roughconductor_terms(material m, vec3 wi, vec3 wo, int distribution) {
    bsdf_terms terms;
    const microfacet_mirror mirror = microfacet_mirror_of(m, wi, wo, distribution);
    terms.pdf = mirror.is_valid ? mirror.pdf : R(0);
    terms.pdf_reverse = mirror.is_valid ? mirror.pdf_reverse : R(0);
    terms.weight = rgb_scale(conductor_reflectance(m, mirror.cosine), terms.pdf > R(0) ? mirror.masking : R(0));
    return terms;
}

GRADUS_FN bsdf_sample roughconductor_sample(material m, vec3 wi, real u1, real u2, int distribution) {
    const vec3 wo = microfacet_mirror_sample(m, wi, u1, u2, distribution);
    return bsdf_sample_of(wo, roughconductor_terms(m, wi, wo, distribution));
}

#define GRADUS_ROUGHCONDUCTOR(name, distribution)                                                                      \
    GRADUS_FN bsdf_value name##_evaluate(material m, vec3 wi, vec3 wo, int mode) {                                     \
        (void)mode;                                                                                                    \
        return bsdf_value_of(roughconductor_terms(m, wi, wo, distribution));                                           \
    }                                                                                                                  \
    GRADUS_FN bsdf_sample name##_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode) {                \
        (void)u_lobe, (void)mode;                                                                                      \
        return roughconductor_sample(m, wi, u1, u2, distribution);                                                     \
    }                                                                                                                  \
    GRADUS_FN rgb name##_albedo(material m) { return conductor_albedo(m); }
GRADUS_ROUGHCONDUCTOR(roughconductor_ggx, microfacet_ggx)
GRADUS_ROUGHCONDUCTOR(roughconductor_beckmann, microfacet_beckmann)
#undef GRADUS_ROUGHCONDUCTOR

GRADUS_LIB_END
#endif
