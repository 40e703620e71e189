/* What every BSDF kind returns, and the conventions they share.
 *
 * Local shading frame: z is the normal. wi points to where the path came from, wo to where it goes; both are unit
 * vectors and point away from the surface. Densities are by solid angle. K_eval returns f |cos wo|, for the
 * transport of radiance: light that crosses into the index eta_o from eta_i carries the factor (eta_i / eta_o)^2
 * along the path. Delta kinds have eval and pdf 0. */
#ifndef GRADUS_LIB_BSDF_SAMPLE_H
#define GRADUS_LIB_BSDF_SAMPLE_H
#include "kernels/lib/vector.h"
#include "kernels/shared/material.h"

GRADUS_LIB_BEGIN

typedef struct {
    vec3 wo;
    rgb weight; /* f |cos wo| / pdf */
    real pdf;   /* by solid angle; for delta kinds the discrete probability; 0: no sample, weight is 0 too */
    real eta;   /* index on wo's side over the index on wi's side; 1 for reflection */
} bsdf_sample;

/* Density and weight of one pair of directions: the sampled kinds form both from the same terms, so that
 * eval = weight pdf holds to rounding. */
typedef struct {
    rgb weight; /* first: returned in registers as (r, g), (b, pdf); the other order stops PoCL's vectoriser */
    real pdf;
    GRADUS_NOT_IN_REGISTERS
} bsdf_terms;

GRADUS_FN rgb material_reflectance(material m) { return rgb3(m.reflectance_r, m.reflectance_g, m.reflectance_b); }
GRADUS_FN rgb material_specular_reflectance(material m) {
    return rgb3(m.specular_reflectance_r, m.specular_reflectance_g, m.specular_reflectance_b);
}
GRADUS_FN rgb material_specular_transmittance(material m) {
    return rgb3(m.specular_transmittance_r, m.specular_transmittance_g, m.specular_transmittance_b);
}

GRADUS_LIB_END
#endif
