/* Value and density of whichever BSDF kind of the scene a material is of: for offset paths, whose vertices are of
 * other kinds than those of their base paths. HAS_kind is 1 for each kind that the scene has. */
#ifndef GRADUS_LIB_BSDF_ANY_H
#define GRADUS_LIB_BSDF_ANY_H
#include "kernels/lib/bsdf.h"
#include "kernels/shared/tables.h"

typedef struct {
    rgb value; /* f |cos wo| */
    real pdf;  /* by solid angle */
    GRADUS_NOT_IN_REGISTERS
} bsdf_value;

/* Independent ifs, not a switch: PoCL vectorises those. */
#if ONE_KIND
#define BSDF_ANY_CASE(name)                                                                                            \
    v.value = name##_eval(m, wi, wo);                                                                                  \
    v.pdf = name##_pdf(m, wi, wo);
#else
#define BSDF_ANY_CASE(name)                                                                                            \
    if (kind == bsdf_kind_##name) {                                                                                    \
        v.value = name##_eval(m, wi, wo);                                                                              \
        v.pdf = name##_pdf(m, wi, wo);                                                                                 \
    }
#endif

/* Zero for Dirac kinds, and for primary_none. */
GRADUS_FN bsdf_value bsdf_any(uint kind, material m, vec3 wi, vec3 wo) {
    bsdf_value v;
    v.value = rgb_gray(R(0));
    v.pdf = R(0);
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

/* 1 for the kinds that a path can reconnect at. By a mask: comparisons one by one become a switch, which PoCL does not
 * vectorise. */
#define GRADUS_ROUGH_BIT(name, is_dirac) | ((is_dirac) ? 0u : 1u << bsdf_kind_##name)
GRADUS_FN int bsdf_is_rough(uint kind) {
    const uint mask = 0u GRADUS_BSDF_KINDS(GRADUS_ROUGH_BIT);
    return (int)((kind < 32u ? 1u : 0u) & (mask >> (kind & 31u)));
}

#endif
