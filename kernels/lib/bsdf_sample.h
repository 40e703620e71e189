/* What every BSDF kind returns, and the conventions they share.
 *
 * Local shading frame: z is the normal. wi points to where the path came from, wo to where it goes; both are unit
 * vectors and point away from the surface. Densities are by solid angle.
 *
 * Values are f |cos wo|. What a path transports decides how they scale where light crosses from the index eta_i on wi's
 * side into eta_o on wo's: radiance, sought from the camera, takes the factor (eta_i / eta_o)^2; importance's adjoint,
 * power that a path from a light carries, takes none (Veach 1997, 5.2). The mode is a compile-time constant wherever it
 * is passed, so that nothing is left of it. Densities do not depend on it. That shading normals are not the surface's
 * own is no business of a BSDF. */
#ifndef GRADUS_LIB_BSDF_SAMPLE_H
#define GRADUS_LIB_BSDF_SAMPLE_H
#include "kernels/lib/vector.h"
#include "kernels/shared/material.h"

GRADUS_LIB_BEGIN

enum transport_mode { transport_radiance, transport_importance };

/* Of one pair of directions. Densities that a caller does not read cost nothing once inlined. All are 0 where there is
 * no such path, and for Dirac lobes, which no given pair meets. */
typedef struct {
    rgb value;        /* f |cos wo| */
    real pdf;         /* of wo, given wi */
    real pdf_reverse; /* of wi, given wo */
    GRADUS_NOT_IN_REGISTERS
} bsdf_value;

typedef struct {
    vec3 wo;
    rgb weight;       /* f |cos wo| / pdf */
    real pdf;         /* by solid angle; of a Dirac lobe its probability; 0: no sample, weight is 0 too */
    real pdf_reverse; /* of wi, given wo; likewise */
    real eta;         /* index on wo's side over the index on wi's side; 1 for reflection */
    real lobe_weight; /* share of the light that the lobe takes over its probability; 1 unless the choice is stratified
                       * (kernels/lib/lobe_chance.h); a factor of weight */
    int is_specular;  /* whether wo came from a Dirac lobe */
    GRADUS_NOT_IN_REGISTERS
} bsdf_sample;

/* What evaluation and sampling form from the same terms, so that value = weight pdf holds to rounding. */
typedef struct {
    rgb weight;
    real pdf, pdf_reverse;
    GRADUS_NOT_IN_REGISTERS
} bsdf_terms;

GRADUS_FN bsdf_value bsdf_value_of(bsdf_terms terms) {
    bsdf_value v;
    v.value = rgb_scale(terms.weight, terms.pdf);
    v.pdf = terms.pdf;
    v.pdf_reverse = terms.pdf_reverse;
    return v;
}

/* Of a rough lobe: wo and its terms; no sample unless is_valid. eta: index on wo's side over the index on wi's. */
GRADUS_FN bsdf_sample bsdf_sample_if(int is_valid, vec3 wo, bsdf_terms terms, real eta) {
    bsdf_sample sample;
    sample.wo = wo;
    sample.weight = rgb_scale(terms.weight, is_valid ? R(1) : R(0));
    sample.pdf = is_valid ? terms.pdf : R(0);
    sample.pdf_reverse = is_valid ? terms.pdf_reverse : R(0);
    sample.eta = eta;
    sample.lobe_weight = R(1);
    sample.is_specular = 0;
    return sample;
}

/* The same of what stays on its side and is a sample wherever its terms say so. */
GRADUS_FN bsdf_sample bsdf_sample_of(vec3 wo, bsdf_terms terms) {
    bsdf_sample sample;
    sample.wo = wo;
    sample.weight = terms.weight;
    sample.pdf = terms.pdf;
    sample.pdf_reverse = terms.pdf_reverse;
    sample.eta = R(1);
    sample.lobe_weight = R(1);
    sample.is_specular = 0;
    return sample;
}

/* Of kinds that are Dirac all through. */
GRADUS_FN bsdf_value bsdf_value_none(void) {
    bsdf_value v;
    v.value = rgb_gray(R(0));
    v.pdf = R(0);
    v.pdf_reverse = R(0);
    return v;
}

/* Light that crosses into an index 1 / inverse_eta times as high. */
GRADUS_FN real transport_scale(real inverse_eta, int mode) {
    return mode == transport_radiance ? inverse_eta * inverse_eta : R(1);
}

GRADUS_FN rgb material_reflectance(material m) { return rgb3(m.reflectance_r, m.reflectance_g, m.reflectance_b); }
GRADUS_FN rgb material_specular_reflectance(material m) {
    return rgb3(m.specular_reflectance_r, m.specular_reflectance_g, m.specular_reflectance_b);
}
GRADUS_FN rgb material_specular_transmittance(material m) {
    return rgb3(m.specular_transmittance_r, m.specular_transmittance_g, m.specular_transmittance_b);
}

GRADUS_LIB_END
#endif
