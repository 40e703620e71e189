/* What photons are worth at gather points. */
#ifndef GRADUS_LIB_PHOTON_VALUE_H
#define GRADUS_LIB_PHOTON_VALUE_H
#include "kernels/lib/bsdf_evaluate.h"
#include "kernels/lib/bsdf_frame.h"
#include "kernels/shared/stage.h"

#ifdef BSDF

/* f power, f without its cosine, at row `row` of `gather`; wo: to where the photon came from, world frame.
 *
 * A photon's flux is what arrives at the surface as it is, so the value |cos| of the BSDF, which is by the shading
 * normal, is divided by the cosine to `normal`, the geometric one where the photon landed (Veach 1997, 5.3): by the
 * gather point's own, photons of a neighbouring facet would count by what that one is tilted. */
#define PHOTON_VALUE(row, m, wo, normal, power)                                                                        \
    photon_value(m, BSDF_FRAME(gather, row, m, AT_V3(gather, wi, row)), AT_V3(gather, wi, row), wo, normal, power)
GRADUS_FN rgb photon_value(material m, bsdf_frame place, vec3 wi, vec3 wo, vec3 normal, rgb power) {
    const vec3 wo_local = frame_to_local(place.axes, wo);
    const bsdf_value v = MAPPED_VALUE(place, bsdf_evaluate(m, frame_to_local(place.axes, wi), wo_local, 0), wo_local);
    const real cosine = r_abs(v3_dot(wo, normal));
    /* A photon that grazes the surface carries no flux to speak of. */
    const real inverse = cosine > R(1e-6) ? R(1) / r_max(cosine, R(1e-6)) : R(0);
    return rgb_scale(rgb_mul(v.value, power), inverse);
}

#endif

#endif
