/* All Dirac kinds as one, for kernels that serve whichever of them a scene has: a scatter that has no lobe to evaluate
 * is cheap, a program more is not. Each kind is computed, and the one that the material's record names is taken. */
#ifndef GRADUS_LIB_BSDF_SPECULAR_H
#define GRADUS_LIB_BSDF_SPECULAR_H
#include "kernels/lib/bsdf_files.h"

GRADUS_LIB_BEGIN

/* By the numbers of the kinds, a bit for each that the scene has. */
#ifndef SPECULAR_KINDS
#define SPECULAR_KINDS 0xFFFFFFFFu
#endif

#define GRADUS_IS_SPECULAR(name, lobes) (((lobes) == 1) & (int)((SPECULAR_KINDS >> bsdf_kind_##name) & 1u))

GRADUS_FN bsdf_value specular_evaluate(material m, vec3 wi, vec3 wo, int mode) {
    (void)m, (void)wi, (void)wo, (void)mode;
    return bsdf_value_none();
}

#define GRADUS_TAKE_SAMPLE(name, lobes, transmits, parameters)                                                         \
    if (GRADUS_IS_SPECULAR(name, lobes)) {                                                                             \
        const bsdf_sample other = name##_sample(m, wi, u_lobe, u1, u2, mode);                                          \
        const int is_other = m.bsdf == R(bsdf_kind_##name);                                                            \
        sample.wo = v3_select(is_other, other.wo, sample.wo);                                                          \
        sample.weight = rgb_select(is_other, other.weight, sample.weight);                                             \
        sample.pdf = is_other ? other.pdf : sample.pdf;                                                                \
        sample.pdf_reverse = is_other ? other.pdf_reverse : sample.pdf_reverse;                                        \
        sample.eta = is_other ? other.eta : sample.eta;                                                                \
        sample.lobe_weight = is_other ? other.lobe_weight : sample.lobe_weight;                                        \
    }
GRADUS_FN bsdf_sample specular_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode) {
    bsdf_sample sample;
    sample.wo = v3_neg(wi);
    sample.weight = rgb_gray(R(0));
    sample.pdf = R(0);
    sample.pdf_reverse = R(0);
    sample.eta = R(1);
    sample.lobe_weight = R(1);
    sample.is_specular = 1;
    GRADUS_BSDF_KINDS(GRADUS_TAKE_SAMPLE)
    return sample;
}
#undef GRADUS_TAKE_SAMPLE

#define GRADUS_TAKE_ALBEDO(name, lobes, transmits, parameters)                                                         \
    if (GRADUS_IS_SPECULAR(name, lobes))                                                                               \
        albedo = rgb_select(m.bsdf == R(bsdf_kind_##name), name##_albedo(m), albedo);
GRADUS_FN rgb specular_albedo(material m) {
    rgb albedo = rgb_gray(R(0));
    GRADUS_BSDF_KINDS(GRADUS_TAKE_ALBEDO)
    return albedo;
}
#undef GRADUS_TAKE_ALBEDO

GRADUS_LIB_END
#endif
