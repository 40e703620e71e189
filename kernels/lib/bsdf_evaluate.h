/* The value of a BSDF of one kind, BSDF, for a pair of directions, whether the kind scatters or mirrors. */
#ifndef GRADUS_LIB_BSDF_EVALUATE_H
#define GRADUS_LIB_BSDF_EVALUATE_H
#include "kernels/lib/bsdf.h"
#include "kernels/shared/stage.h"

#ifdef BSDF

/* Of radiance. Kinds with a Dirac lobe beside rough ones: of the one that is asked for (asks_dirac, which others do not
 * read). Specular kinds: reflection or transmission, as wo says by its side, which is all that counts of it: the
 * factor on what arrives times the probability, and the probability. 0 where the kind does not do that. */
GRADUS_FN bsdf_value bsdf_evaluate(material m, vec3 wi, vec3 wo, int asks_dirac) {
    (void)asks_dirac;
#if BSDF_IS_DIRAC
    const int is_reflected = wi.z * wo.z > R(0);
    /* Below and above all reflectances: where there is a choice, the event is given. */
    const bsdf_sample s = PASTE(BSDF, _sample)(m, wi, is_reflected ? R(-1) : R(2), R(0), R(0), transport_radiance);
    const int is_that = (s.wo.z * wi.z > R(0)) == is_reflected;
    bsdf_value v = bsdf_value_none();
    v.pdf = is_that ? s.pdf : R(0);
    v.value = rgb_scale(s.weight, v.pdf);
    return v;
#elif BSDF_IS_MIXED
    const bsdf_value rough = PASTE(BSDF, _evaluate)(m, wi, wo, transport_radiance);
    const bsdf_sample s = PASTE(BSDF, _sample)(m, wi, R(-1), R(0.5), R(0.5), transport_radiance);
    const real chance = wi.z * wo.z > R(0) ? s.pdf : R(0);
    bsdf_value v;
    v.pdf = asks_dirac ? chance : rough.pdf;
    v.pdf_reverse = asks_dirac ? chance : rough.pdf_reverse;
    v.value = rgb_select(asks_dirac, rgb_scale(s.weight, chance), rough.value);
    return v;
#else
    return PASTE(BSDF, _evaluate)(m, wi, wo, transport_radiance);
#endif
}

#endif

#endif
