/* An invisible surface: the path goes straight on. */
#ifndef GRADUS_LIB_BSDF_NULL_H
#define GRADUS_LIB_BSDF_NULL_H
#include "kernels/lib/bsdf_sample.h"

GRADUS_LIB_BEGIN

GRADUS_FN bsdf_value null_evaluate(material m, vec3 wi, vec3 wo, int mode) {
    (void)m, (void)wi, (void)wo, (void)mode;
    return bsdf_value_none();
}

GRADUS_FN bsdf_sample null_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode) {
    (void)m, (void)u_lobe, (void)u1, (void)u2, (void)mode;
    bsdf_sample sample;
    sample.wo = v3_neg(wi);
    sample.weight = rgb_gray(R(1));
    sample.pdf = R(1);
    sample.pdf_reverse = R(1);
    sample.eta = R(1);
    sample.lobe_weight = R(1);
    sample.is_specular = 1;
    return sample;
}

GRADUS_FN rgb null_albedo(material m) {
    (void)m;
    return rgb_gray(R(1));
}

GRADUS_LIB_END
#endif
