/* Whichever BSDF kind of the scene a material is of: for offset paths, whose vertices are of other kinds than those of
 * their base paths. HAS_kind is 1 for each kind that the scene has. */
#ifndef GRADUS_LIB_BSDF_ANY_H
#define GRADUS_LIB_BSDF_ANY_H
#include "kernels/lib/bsdf.h"
#include "kernels/shared/tables.h"

/* Independent ifs, not a switch: PoCL vectorises those. */
#if ONE_KIND
#define BSDF_ANY_IF(name)
#else
#define BSDF_ANY_IF(name) if (kind_number(kind) == bsdf_kind_##name)
#endif
#define BSDF_ANY_CASE(name)                                                                                            \
    BSDF_ANY_IF(name) {                                                                                                \
        const bsdf_value own = name##_evaluate(m, wi, wo, transport_radiance);                                         \
        v.value = own.value;                                                                                           \
        v.pdf = own.pdf;                                                                                               \
    }

/* Zero for Dirac kinds; without the density of the way back. */
GRADUS_FN bsdf_value bsdf_any(uint kind, material m, vec3 wi, vec3 wo) {
    bsdf_value v = bsdf_value_none();
    (void)kind, (void)m, (void)wi, (void)wo;
#if HAS_diffuse
    BSDF_ANY_CASE(diffuse)
#endif
#if HAS_roughconductor_ggx
    BSDF_ANY_CASE(roughconductor_ggx)
#endif
#if HAS_roughconductor_beckmann
    BSDF_ANY_CASE(roughconductor_beckmann)
#endif
#if HAS_roughdielectric_ggx
    BSDF_ANY_CASE(roughdielectric_ggx)
#endif
#if HAS_roughdielectric_beckmann
    BSDF_ANY_CASE(roughdielectric_beckmann)
#endif
    return v;
}

/* Reflection, or transmission, at a Dirac kind: zero where it does neither, and for other kinds. */
GRADUS_FN bsdf_value bsdf_any_dirac(uint kind, material m, vec3 wi, int is_reflected) {
    rgb weight = rgb_gray(R(0));
    real pdf = R(0);
    (void)kind, (void)m, (void)wi, (void)is_reflected;
#if HAS_conductor
    BSDF_ANY_IF(conductor) {
        const bsdf_sample s = conductor_sample(m, wi, R(0), R(0), R(0), transport_radiance);
        weight = s.weight;
        pdf = is_reflected ? s.pdf : R(0);
    }
#endif
#if HAS_dielectric
    BSDF_ANY_IF(dielectric) {
        /* Below and above all reflectances: the event is given. */
        const bsdf_sample s = dielectric_sample(m, wi, is_reflected ? R(-1) : R(2), R(0), R(0), transport_radiance);
        weight = s.weight;
        pdf = s.pdf;
    }
#endif
#if HAS_null
    BSDF_ANY_IF(null) {
        weight = rgb_gray(R(1));
        pdf = is_reflected ? R(0) : R(1);
    }
#endif
    bsdf_value v = bsdf_value_none();
    v.value = rgb_scale(weight, pdf); /* the factor on what arrives */
    v.pdf = pdf;
    return v;
}

#endif
