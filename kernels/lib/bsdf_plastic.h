/* Smooth plastic, one-sided: a diffuse base under a smooth dielectric coat (kernels/lib/coat.h). Its Dirac lobe is the
 * mirror image in the coat, its rough one the base: evaluation gives the base alone, and its densities hold the chance
 * that it is sampled. u_lobe below all chances asks for the Dirac lobe. */
#ifndef GRADUS_LIB_BSDF_PLASTIC_H
#define GRADUS_LIB_BSDF_PLASTIC_H
#include "kernels/lib/coat.h"
#include "kernels/lib/fresnel.h"
#include "kernels/lib/warp.h"

GRADUS_LIB_BEGIN

/* Of the rough lobe, and what the Dirac one needs. */
typedef struct {
    bsdf_terms rough;
    real reflectance; /* of the coat, at wi */
    real chance;      /* that it is sampled */
    GRADUS_NOT_IN_REGISTERS
} plastic_terms_result;

GRADUS_FN plastic_terms_result plastic_terms(material m, vec3 wi, vec3 wo) {
    plastic_terms_result terms;
    const int is_valid = (wi.z > R(0)) & (wo.z > R(0));
    const rgb specular = material_specular_reflectance(m), albedo = material_reflectance(m);
    terms.reflectance = fresnel_dielectric(r_clamp(wi.z, R(0), R(1)), m.ior).reflectance;
    terms.chance = coat_chance(terms.reflectance, specular, albedo);
    const real cosine_after = r_after(r_clamp(wo.z, R(0), R(1)), terms.chance);
    const real reflectance_to = fresnel_dielectric(cosine_after, m.ior).reflectance;
    const real chance_to = coat_chance(reflectance_to, specular, albedo);
    const real base_chance = R(1) - terms.chance;
    terms.rough.pdf = is_valid ? base_chance * warp_cosine_hemisphere_pdf(wo.z) : R(0);
    terms.rough.pdf_reverse = is_valid ? (R(1) - chance_to) * warp_cosine_hemisphere_pdf(wi.z) : R(0);
    const real passed = (R(1) - terms.reflectance) * (R(1) - reflectance_to) / r_max(base_chance, R(1e-10));
    terms.rough.weight = rgb_scale(coat_base(m), terms.rough.pdf > R(0) ? passed : R(0));
    return terms;
}

GRADUS_FN bsdf_value plastic_evaluate(material m, vec3 wi, vec3 wo, int mode) {
    (void)mode;
    return bsdf_value_of(plastic_terms(m, wi, wo).rough);
}

GRADUS_FN bsdf_sample plastic_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode) {
    (void)mode;
    bsdf_sample sample;
    const vec3 scattered = warp_cosine_hemisphere(u1, u2);
    const plastic_terms_result terms = plastic_terms(m, wi, scattered);
    const int is_mirrored = u_lobe < terms.chance;
    sample.wo = v3_select(is_mirrored, v3(-wi.x, -wi.y, wi.z), scattered);
    const real mirrored_pdf = wi.z > R(0) ? terms.chance : R(0);
    const real mirrored = mirrored_pdf > R(0) ? terms.reflectance / r_max(terms.chance, R(1e-20)) : R(0);
    sample.weight = rgb_select(is_mirrored, rgb_scale(material_specular_reflectance(m), mirrored), terms.rough.weight);
    sample.pdf = is_mirrored ? mirrored_pdf : terms.rough.pdf;
    /* The way back meets the coat at the same cosine. */
    sample.pdf_reverse = is_mirrored ? mirrored_pdf : terms.rough.pdf_reverse;
    sample.eta = R(1);
    sample.lobe_weight = R(1);
    sample.is_specular = is_mirrored;
    return sample;
}

/* The coat mirrors its mean share; the rest comes from the base, through the coat twice. */
GRADUS_FN rgb plastic_albedo(material m) {
    const real reflectance = fresnel_mean(fresnel_dielectric(R(1), m.ior).reflectance);
    const real passed = (R(1) - reflectance) * (R(1) - reflectance);
    return rgb_add(rgb_scale(material_specular_reflectance(m), reflectance), rgb_scale(coat_base(m), passed));
}

GRADUS_LIB_END
#endif
