/* A rough conductor, one-sided: f = F D G1(wi) G1(wo) / (4 cos wi cos wo) (Walter et al. 2007, eq. 20), sampled by
 * visible normals: pdf(wo) = D(h) / (4 sigma(wi)), weight = F G1(wo). */
#ifndef GRADUS_LIB_BSDF_ROUGHCONDUCTOR_H
#define GRADUS_LIB_BSDF_ROUGHCONDUCTOR_H
#include "kernels/lib/bsdf_conductor.h"
#include "kernels/lib/microfacet.h"

GRADUS_LIB_BEGIN

GRADUS_FN bsdf_terms roughconductor_terms(material m, vec3 wi, vec3 wo, int distribution) {
    bsdf_terms terms;
    const real alpha_u = microfacet_alpha(m.alpha_u);
    const real alpha_v = microfacet_alpha(r_after(m.alpha_v, alpha_u));
    const int is_valid = r_min(wi.z, wo.z) > R(0);
    /* Directions below the horizon are computed as if above, and dropped at the end. */
    const vec3 from = v3(wi.x, wi.y, r_abs(wi.z));
    const vec3 to = v3(wo.x, wo.y, r_abs(r_after(wo.z, from.z)));
    const vec3 h = v3_ordered(v3_add(from, to));
    const real length_squared = v3_dot(h, h);
    const real density = microfacet_density(distribution, h, length_squared, alpha_u, alpha_v);
    const real pdf = R(0.25) * density / microfacet_projected_area(distribution, from, alpha_u, alpha_v);
    const vec3 later = v3(r_after(to.x, pdf), r_after(to.y, pdf), to.z);
    const real area_to = microfacet_projected_area(distribution, later, alpha_u, alpha_v);
    const real masking = to.z / area_to;
    /* wi . m = |h| / 2 */
    const real cosine = r_min(R(0.5) * r_sqrt(length_squared), R(1));
    terms.pdf = is_valid ? pdf : R(0);
    terms.pdf_reverse = is_valid ? R(0.25) * density / area_to : R(0);
    terms.weight = rgb_scale(conductor_reflectance(m, cosine), terms.pdf > R(0) ? masking : R(0));
    return terms;
}

GRADUS_FN bsdf_sample roughconductor_sample(material m, vec3 wi, real u1, real u2, int distribution) {
    bsdf_sample sample;
    const vec3 from = v3(wi.x, wi.y, r_abs(wi.z));
    /* Written as in roughconductor_terms, so that what both compute from wi is computed once. */
    const real alpha_u = microfacet_alpha(m.alpha_u);
    const real alpha_v = microfacet_alpha(r_after(m.alpha_v, alpha_u));
    const vec3 normal = microfacet_sample_visible(distribution, from, alpha_u, alpha_v, u1, u2);
    sample.wo = v3_mad(v3_neg(from), R(2) * v3_dot(from, normal), normal);
    const bsdf_terms terms = roughconductor_terms(m, wi, sample.wo, distribution);
    sample.weight = terms.weight;
    sample.pdf = terms.pdf;
    sample.pdf_reverse = terms.pdf_reverse;
    sample.eta = R(1);
    sample.is_specular = 0;
    return sample;
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
