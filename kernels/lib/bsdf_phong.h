/* Phong's lobe around the mirror direction beside a diffuse one, one-sided (Lafortune and Willems 1994):
 *     f = reflectance / pi + specular_reflectance (exponent + 2) / (2 pi) max(0, cos)^exponent,
 * cos between wo and the mirror image of wi. alpha_u and alpha_v, which say how rough it counts, follow from the
 * exponent and are not read. */
#ifndef GRADUS_LIB_BSDF_PHONG_H
#define GRADUS_LIB_BSDF_PHONG_H
#include "kernels/lib/approximation.h"
#include "kernels/lib/bsdf_sample.h"
#include "kernels/lib/frame.h"
#include "kernels/lib/lobe_share.h"
#include "kernels/lib/warp.h"

GRADUS_LIB_BEGIN

GRADUS_FN bsdf_terms phong_terms(material m, vec3 wi, vec3 wo) {
    bsdf_terms terms;
    const int is_valid = (wi.z > R(0)) & (wo.z > R(0));
    const rgb specular = material_specular_reflectance(m), albedo = material_reflectance(m);
    const real share = lobe_share(specular, albedo);
    const real cosine = r_min(wi.z * wo.z - wi.x * wo.x - wi.y * wo.y, R(1));
    const real power = cosine > R(0) ? approx_exp(m.exponent * approx_log(r_max(cosine, R(1e-30)))) : R(0);
    const real lobe_pdf = (m.exponent + R(1)) * R(0.5) * GRADUS_INV_PI * power;
    const real diffuse_pdf = warp_cosine_hemisphere_pdf(wo.z);
    const real pdf = share * lobe_pdf + (R(1) - share) * diffuse_pdf;
    terms.pdf = is_valid ? pdf : R(0);
    terms.pdf_reverse = is_valid ? share * lobe_pdf + (R(1) - share) * warp_cosine_hemisphere_pdf(wi.z) : R(0);
    const real inverse = terms.pdf > R(0) ? R(1) / r_max(pdf, R(1e-30)) : R(0);
    const real lobe = (m.exponent + R(2)) * R(0.5) * GRADUS_INV_PI * power * wo.z;
    terms.weight = rgb_add(rgb_scale(albedo, diffuse_pdf * inverse), rgb_scale(specular, lobe * inverse));
    return terms;
}

GRADUS_FN bsdf_value phong_evaluate(material m, vec3 wi, vec3 wo, int mode) {
    (void)mode;
    return bsdf_value_of(phong_terms(m, wi, wo));
}

GRADUS_FN bsdf_sample phong_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode) {
    (void)mode;
    bsdf_sample sample;
    /* cos^(exponent + 1) is uniform. 1 - cos without cancellation where the exponent is high. */
    const real logarithm = approx_log(r_max(u1, R(1e-30))) / (m.exponent + R(1));
    const real one_minus_cosine = logarithm > R(-0.01)
                                      ? -logarithm * (R(1) + logarithm * (R(0.5) + logarithm * R(0.16666667)))
                                      : R(1) - approx_exp(logarithm);
    const real radius = r_sqrt(r_max(one_minus_cosine * (R(2) - one_minus_cosine), R(0)));
    const sine_cosine turn = approx_sine_cosine_2pi(u2);
    const frame around = frame_from_normal(v3(-wi.x, -wi.y, wi.z));
    const vec3 near = v3(radius * turn.cosine, radius * turn.sine, R(1) - one_minus_cosine);
    const vec3 mirrored = frame_to_world(around, near);
    const vec3 scattered = warp_cosine_hemisphere(u1, r_after(u2, mirrored.z));
    const real share = lobe_share(material_specular_reflectance(m), material_reflectance(m));
    sample.wo = v3_select(u_lobe < share, mirrored, scattered);
    const bsdf_terms terms = phong_terms(m, wi, sample.wo);
    sample.weight = terms.weight;
    sample.pdf = terms.pdf;
    sample.pdf_reverse = terms.pdf_reverse;
    sample.eta = R(1);
    sample.is_specular = 0;
    return sample;
}

GRADUS_FN rgb phong_albedo(material m) {
    /* Of the lobe a part is below the horizon: a third on average. */
    return rgb_add(material_reflectance(m), rgb_scale(material_specular_reflectance(m), R(0.7)));
}

GRADUS_LIB_END
#endif
