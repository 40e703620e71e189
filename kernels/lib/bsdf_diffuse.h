/* Lambertian reflection, one-sided: f = reflectance / pi. */
#ifndef GRADUS_LIB_BSDF_DIFFUSE_H
#define GRADUS_LIB_BSDF_DIFFUSE_H
#include "kernels/lib/bsdf_sample.h"
#include "kernels/lib/warp.h"

GRADUS_LIB_BEGIN

GRADUS_FN real diffuse_pdf(material m, vec3 wi, vec3 wo) {
    (void)m;
    const int is_valid = (wi.z > R(0)) & (wo.z > R(0));
    return is_valid ? warp_cosine_hemisphere_pdf(wo.z) : R(0);
}

GRADUS_FN rgb diffuse_eval(material m, vec3 wi, vec3 wo) {
    return rgb_scale(material_reflectance(m), diffuse_pdf(m, wi, wo));
}

GRADUS_FN bsdf_sample diffuse_sample(material m, vec3 wi, real u_lobe, real u1, real u2) {
    (void)u_lobe;
    bsdf_sample sample;
    sample.wo = warp_cosine_hemisphere(u1, u2);
    sample.pdf = diffuse_pdf(m, wi, sample.wo);
    sample.weight = rgb_scale(material_reflectance(m), sample.pdf > R(0) ? R(1) : R(0));
    sample.eta = R(1);
    return sample;
}

GRADUS_FN rgb diffuse_albedo(material m) { return material_reflectance(m); }

GRADUS_LIB_END
#endif
