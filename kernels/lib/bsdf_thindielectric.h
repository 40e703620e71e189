/* A thin pane of a smooth dielectric, with the same medium on both sides: light is mirrored, or passes straight on. Of
 * what enters the pane a part is thrown to and fro in it; with the reflectance R of one side the whole pane reflects
 * R + (1 - R)^2 R (1 + R^2 + R^4 + ...) = 2 R / (1 + R). pane_ior is the index of the pane over that around it. */
#ifndef GRADUS_LIB_BSDF_THINDIELECTRIC_H
#define GRADUS_LIB_BSDF_THINDIELECTRIC_H
#include "kernels/lib/bsdf_sample.h"
#include "kernels/lib/fresnel.h"
#include "kernels/lib/lobe_chance.h"

GRADUS_LIB_BEGIN

GRADUS_FN real thindielectric_reflectance(material m, real cosine) {
    const real once = fresnel_dielectric(r_min(r_abs(cosine), R(1)), m.pane_ior).reflectance;
    return R(2) * once / (R(1) + once);
}

GRADUS_FN bsdf_value thindielectric_evaluate(material m, vec3 wi, vec3 wo, int mode) {
    (void)m, (void)wi, (void)wo, (void)mode;
    return bsdf_value_none();
}

GRADUS_FN bsdf_sample thindielectric_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode) {
    (void)u1, (void)u2;
    bsdf_sample sample;
    const real reflectance = thindielectric_reflectance(m, wi.z);
    const real chance = reflection_chance(reflectance, mode == transport_radiance);
    const int is_reflected = u_lobe < chance;
    const real share = is_reflected ? reflectance : R(1) - reflectance;
    sample.wo = v3(-wi.x, -wi.y, is_reflected ? wi.z : -wi.z);
    sample.pdf = is_reflected ? chance : R(1) - chance;
    sample.lobe_weight = lobe_weight(share, sample.pdf);
    sample.weight =
        rgb_scale(rgb_select(is_reflected, material_specular_reflectance(m), material_specular_transmittance(m)),
                  sample.lobe_weight);
    sample.pdf_reverse = sample.pdf;
    sample.eta = R(1);
    sample.is_specular = 1;
    return sample;
}

/* Reflected and transmitted light together, at normal incidence and on average. */
GRADUS_FN rgb thindielectric_albedo(material m) {
    const real reflectance = fresnel_mean(thindielectric_reflectance(m, R(1)));
    return rgb_add(rgb_scale(material_specular_reflectance(m), reflectance),
                   rgb_scale(material_specular_transmittance(m), R(1) - reflectance));
}

GRADUS_LIB_END
#endif
