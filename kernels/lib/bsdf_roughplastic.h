/* Rough plastic, one-sided: a diffuse base under a rough dielectric coat. The coat is a microfacet surface (Walter et
 * al. 2007, eq. 20), the base is as in kernels/lib/coat.h. The coat's transmittance T at a direction of cosine mu, that
 * of its visible normals on average, is a polynomial in 2 sqrt(mu) - 1 that the host fits (runtime/scene/coating.h). */
#ifndef GRADUS_LIB_BSDF_ROUGHPLASTIC_H
#define GRADUS_LIB_BSDF_ROUGHPLASTIC_H
#include "kernels/lib/coat.h"
#include "kernels/lib/fresnel.h"
#include "kernels/lib/microfacet_event.h"
#include "kernels/lib/warp.h"

GRADUS_LIB_BEGIN

GRADUS_FN real roughplastic_transmittance(material m, real cosine) {
    const real x = R(2) * r_sqrt(r_max(cosine, R(0))) - R(1);
    real t = m.coat_9;
    t = t * x + m.coat_8;
    t = t * x + m.coat_7;
    t = t * x + m.coat_6;
    t = t * x + m.coat_5;
    t = t * x + m.coat_4;
    t = t * x + m.coat_3;
    t = t * x + m.coat_2;
    t = t * x + m.coat_1;
    t = t * x + m.coat_0;
    return r_clamp(t, R(0), R(1));
}

/* What a rough coat does not let pass it mostly reflects; never less than it does at normal incidence. */
GRADUS_FN real roughplastic_chance(material m, real transmittance) {
    const real reflectance = r_max(R(1) - transmittance, fresnel_at_normal(m.ior));
    return coat_chance(reflectance, material_specular_reflectance(m), material_reflectance(m));
}

GRADUS_FN bsdf_terms roughplastic_terms(material m, vec3 wi, vec3 wo, int distribution) {
    bsdf_terms terms;
    const microfacet_mirror mirror = microfacet_mirror_of(m, wi, wo, distribution);
    const real from_z = mirror.from.z, to_z = mirror.to.z;
    const real coat = fresnel_dielectric(mirror.cosine, m.ior).reflectance * mirror.pdf * mirror.masking;
    const real passed = roughplastic_transmittance(m, from_z);
    const real passed_to = roughplastic_transmittance(m, r_after(to_z, passed));
    const real chance = roughplastic_chance(m, passed), chance_to = roughplastic_chance(m, r_after(passed_to, chance));
    const real pdf = chance * mirror.pdf + (R(1) - chance) * warp_cosine_hemisphere_pdf(to_z);
    const real pdf_reverse = chance_to * mirror.pdf_reverse + (R(1) - chance_to) * warp_cosine_hemisphere_pdf(from_z);
    terms.pdf = mirror.is_valid ? pdf : R(0);
    terms.pdf_reverse = mirror.is_valid ? pdf_reverse : R(0);
    const real inverse = terms.pdf > R(0) ? R(1) / r_max(pdf, R(1e-30)) : R(0);
    const rgb of_coat = rgb_scale(material_specular_reflectance(m), coat * inverse);
    const rgb of_base = rgb_scale(coat_base(m), passed * passed_to * warp_cosine_hemisphere_pdf(to_z) * inverse);
    terms.weight = rgb_add(of_coat, of_base);
    return terms;
}

GRADUS_FN bsdf_sample roughplastic_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int distribution) {
    const vec3 mirrored = microfacet_mirror_sample(m, wi, u1, u2, distribution);
    const vec3 scattered = warp_cosine_hemisphere(u1, r_after(u2, mirrored.z));
    const real chance = roughplastic_chance(m, roughplastic_transmittance(m, r_abs(wi.z)));
    const vec3 wo = v3_select(u_lobe < chance, mirrored, scattered);
    return bsdf_sample_of(wo, roughplastic_terms(m, wi, wo, distribution));
}

GRADUS_FN rgb roughplastic_albedo(material m) {
    const real reflectance = fresnel_mean(fresnel_dielectric(R(1), m.ior).reflectance);
    const real passed = roughplastic_transmittance(m, R(0.7));
    return rgb_add(rgb_scale(material_specular_reflectance(m), reflectance), rgb_scale(coat_base(m), passed * passed));
}

#define GRADUS_ROUGHPLASTIC(name, distribution)                                                                        \
    GRADUS_FN bsdf_value name##_evaluate(material m, vec3 wi, vec3 wo, int mode) {                                     \
        (void)mode;                                                                                                    \
        return bsdf_value_of(roughplastic_terms(m, wi, wo, distribution));                                             \
    }                                                                                                                  \
    GRADUS_FN bsdf_sample name##_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode) {                \
        (void)mode;                                                                                                    \
        return roughplastic_sample(m, wi, u_lobe, u1, u2, distribution);                                               \
    }                                                                                                                  \
    GRADUS_FN rgb name##_albedo(material m) { return roughplastic_albedo(m); }
GRADUS_ROUGHPLASTIC(roughplastic_ggx, microfacet_ggx)
GRADUS_ROUGHPLASTIC(roughplastic_beckmann, microfacet_beckmann)
#undef GRADUS_ROUGHPLASTIC

GRADUS_LIB_END
#endif
