/* A smooth dielectric interface: mirror reflection or refraction, the lobe chosen by Fresnel, or nearly so where camera
 * paths are stratified (kernels/lib/lobe_chance.h). The normal points outside; ior is the index inside over the index
 * outside. */
#ifndef GRADUS_LIB_BSDF_DIELECTRIC_H
#define GRADUS_LIB_BSDF_DIELECTRIC_H
#include "kernels/lib/bsdf_sample.h"
#include "kernels/lib/fresnel.h"
#include "kernels/lib/lobe_chance.h"

GRADUS_LIB_BEGIN

GRADUS_FN bsdf_value dielectric_evaluate(material m, vec3 wi, vec3 wo, int mode) {
    (void)m, (void)wi, (void)wo, (void)mode;
    return bsdf_value_none();
}

GRADUS_FN bsdf_sample dielectric_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode) {
    (void)u1, (void)u2;
    bsdf_sample sample;
    const real side = r_copysign1(wi.z);
    const real eta = side > R(0) ? m.ior : R(1) / m.ior;
    const real inverse_eta = R(1) / eta;
    const fresnel_dielectric_result fresnel = fresnel_dielectric(r_min(r_abs(wi.z), R(1)), eta);
    const real chance = reflection_chance(fresnel.reflectance, mode == transport_radiance);
    const int is_reflected = u_lobe < chance;
    sample.wo = v3(is_reflected ? -wi.x : -wi.x * inverse_eta, is_reflected ? -wi.y : -wi.y * inverse_eta,
                   is_reflected ? wi.z : -side * fresnel.cosine_transmitted);
    const rgb transmitted = rgb_scale(material_specular_transmittance(m), transport_scale(inverse_eta, mode));
    const real share = is_reflected ? fresnel.reflectance : R(1) - fresnel.reflectance;
    sample.pdf = is_reflected ? chance : R(1) - chance;
    sample.lobe_weight = lobe_weight(share, sample.pdf);
    sample.weight =
        rgb_scale(rgb_select(is_reflected, material_specular_reflectance(m), transmitted), sample.lobe_weight);
    /* Fresnel's reflectance is the same from both sides of a refracted ray. */
    sample.pdf_reverse = sample.pdf;
    sample.eta = is_reflected ? R(1) : eta;
    sample.is_specular = 1;
    return sample;
}

/* Reflected and transmitted light together, at normal incidence and on average. */
GRADUS_FN rgb dielectric_albedo(material m) {
    const real reflectance = fresnel_mean(fresnel_dielectric(R(1), m.ior).reflectance);
    return rgb_add(rgb_scale(material_specular_reflectance(m), reflectance),
                   rgb_scale(material_specular_transmittance(m), R(1) - reflectance));
}

GRADUS_LIB_END
#endif
