/* The value of a BSDF of one kind, BSDF, for a pair of directions, whether the kind scatters or mirrors. */
#ifndef GRADUS_LIB_BSDF_EVALUATE_H
#define GRADUS_LIB_BSDF_EVALUATE_H
#include "kernels/lib/bsdf.h"
#include "kernels/shared/stage.h"

#ifdef BSDF

/* Of radiance. Specular kinds: reflection or transmission, as wo says by its side, which is all that counts of it: the
 * factor on what arrives times the probability, and the probability. 0 where the kind does not do that. */
GRADUS_FN bsdf_value bsdf_evaluate(material m, vec3 wi, vec3 wo) {
#if BSDF_IS_DIRAC
    const int is_reflected = wi.z * wo.z > R(0);
    /* Below and above all reflectances: where there is a choice, the event is given. */
    const bsdf_sample s = PASTE(BSDF, _sample)(m, wi, is_reflected ? R(-1) : R(2), R(0), R(0), transport_radiance);
    const int is_that = (s.wo.z * wi.z > R(0)) == is_reflected;
    bsdf_value v = bsdf_value_none();
    v.pdf = is_that ? s.pdf : R(0);
    v.value = rgb_scale(s.weight, v.pdf);
    return v;
#else
    return PASTE(BSDF, _evaluate)(m, wi, wo, transport_radiance);
#endif
}

#endif

#endif
