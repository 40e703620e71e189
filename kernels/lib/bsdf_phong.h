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
    const int is_valid = (wi.z > R(0)) & (wo.z > R(0));
    /* 1 - cos without cancellation, which a high exponent would raise; near 0 the series of the logarithm. */
    const real c = R(0.5) * v3_length_squared(v3(wo.x + wi.x, wo.y + wi.y, wo.z - wi.z));
    const real series =
        R(1) + c * (R(1.0 / 2) + c * (R(1.0 / 3) + c * (R(1.0 / 4) + c * (R(1.0 / 5) + c * R(1.0 / 6)))));
    const real logarithm = c < R(1.0 / 256) ? -c * series : approx_log(r_max(R(1) - c, R(1e-30)));
    const real power = c < R(1) ? approx_exp(m.exponent * logarithm) : R(0);
    const real lobe_pdf = (m.exponent + R(1)) * R(0.5) * GRADUS_INV_PI * power;
    const real lobe = (m.exponent + R(2)) * R(0.5) * GRADUS_INV_PI * power * wo.z;
    return lobe_beside_diffuse(m, wi, wo, is_valid, lobe_pdf, lobe);
}

GRADUS_FN bsdf_value phong_evaluate(material m, vec3 wi, vec3 wo, int mode) {
    (void)mode;
    return bsdf_value_of(phong_terms(m, wi, wo));
}

GRADUS_FN bsdf_sample phong_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode) {
    (void)mode;
    /* cos^(exponent + 1) is uniform. 1 - cos without cancellation where the exponent is high. */
    const real logarithm = approx_log(r_max(u1, R(1e-30))) / (m.exponent + R(1));
    const real one_minus_cosine = logarithm > R(-0.01)
                                      ? -logarithm * (R(1) + logarithm * (R(0.5) + logarithm * R(0.16666667)))
                                      : R(1) - approx_exp(logarithm);
    const real radius = r_sqrt(r_max(one_minus_cosine * (R(2) - one_minus_cosine), R(0)));
    const sine_cosine turn = approx_sine_cosine_2pi(u2);
    const frame around = frame_from_normal(v3(-wi.x, -wi.y, wi.z));
    const vec3 near = v3(radius * turn.cosine, radius * turn.sine, R(1) - one_minus_cosine);
    const vec3 wo = lobe_or_diffuse(m, frame_to_world(around, near), u_lobe, u1, u2);
    return bsdf_sample_of(wo, phong_terms(m, wi, wo));
}

GRADUS_FN rgb phong_albedo(material m) {
    /* Of the lobe a part is below the horizon: a third on average. */
    return rgb_add(material_reflectance(m), rgb_scale(material_specular_reflectance(m), R(0.7)));
}

GRADUS_LIB_END
#endif
