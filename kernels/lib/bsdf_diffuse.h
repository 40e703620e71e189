/* Lambertian reflection, one-sided: f = reflectance / pi. */
#ifndef GRADUS_LIB_BSDF_DIFFUSE_H
#define GRADUS_LIB_BSDF_DIFFUSE_H
#include "kernels/lib/bsdf_sample.h"
#include "kernels/lib/warp.h"

GRADUS_LIB_BEGIN

GRADUS_FN bsdf_terms diffuse_terms(material m, vec3 wi, vec3 wo) {
    bsdf_terms terms;
    const int is_valid = (wi.z > R(0)) & (wo.z > R(0));
    terms.pdf = is_valid ? warp_cosine_hemisphere_pdf(wo.z) : R(0);
    terms.pdf_reverse = is_valid ? warp_cosine_hemisphere_pdf(wi.z) : R(0);
    terms.weight = rgb_scale(material_reflectance(m), terms.pdf > R(0) ? R(1) : R(0));
    return terms;
}

GRADUS_FN bsdf_value diffuse_evaluate(material m, vec3 wi, vec3 wo, int mode) {
    (void)mode;
    bsdf_value v;
    const bsdf_terms terms = diffuse_terms(m, wi, wo);
    v.value = rgb_scale(material_reflectance(m), terms.pdf);
    v.pdf = terms.pdf;
    v.pdf_reverse = terms.pdf_reverse;
    return v;
}

GRADUS_FN bsdf_sample diffuse_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode) {
    (void)u_lobe, (void)mode;
    const vec3 wo = warp_cosine_hemisphere(u1, u2);
    return bsdf_sample_of(wo, diffuse_terms(m, wi, wo));
}

GRADUS_FN rgb diffuse_albedo(material m) { return material_reflectance(m); }

GRADUS_LIB_END
#endif
