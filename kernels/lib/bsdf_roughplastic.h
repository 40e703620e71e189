/* Rough plastic, one-sided: a diffuse base under a rough dielectric coat. The coat is a microfacet surface (Walter et
 * al. 2007, eq. 20), the base is as in kernels/lib/coat.h. The coat's transmittance T at a direction of cosine mu, that
 * of its visible normals on average, is a polynomial in 2 sqrt(mu) - 1 that the host fits (runtime/scene/coating.h). */
#ifndef GRADUS_LIB_BSDF_ROUGHPLASTIC_H
#define GRADUS_LIB_BSDF_ROUGHPLASTIC_H
#include "kernels/lib/coat.h"
#include "kernels/lib/fresnel.h"
#include "kernels/lib/microfacet.h"
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
    const real at_normal = (m.ior - R(1)) / (m.ior + R(1));
    const real reflectance = r_max(R(1) - transmittance, at_normal * at_normal);
    return coat_chance(reflectance, material_specular_reflectance(m), material_reflectance(m));
}

GRADUS_FN bsdf_terms roughplastic_terms(material m, vec3 wi, vec3 wo, int distribution) {
    bsdf_terms terms;
    const real alpha_u = microfacet_alpha(m.alpha_u);
    const real alpha_v = microfacet_alpha(r_after(m.alpha_v, alpha_u));
    const int is_valid = r_min(wi.z, wo.z) > R(0);
    /* Directions below the horizon are computed as if above, and dropped at the end. */
    const vec3 from = v3(wi.x, wi.y, r_abs(wi.z));
    const vec3 to = v3(wo.x, wo.y, r_abs(r_after(wo.z, from.z)));
    const vec3 h = v3_ordered(v3_add(from, to));
    const real length_squared = v3_dot(h, h);
    const real density = R(0.25) * microfacet_density(distribution, h, length_squared, alpha_u, alpha_v);
    const real coat_pdf = density / microfacet_projected_area(distribution, from, alpha_u, alpha_v);
    const vec3 later = v3(r_after(to.x, coat_pdf), r_after(to.y, coat_pdf), to.z);
    const real area_to = microfacet_projected_area(distribution, later, alpha_u, alpha_v);
    /* wi . m = |h| / 2 */
    const real cosine = r_min(R(0.5) * r_sqrt(length_squared), R(1));
    const real coat = fresnel_dielectric(cosine, m.ior).reflectance * coat_pdf * (to.z / area_to);
    const real passed = roughplastic_transmittance(m, from.z);
    const real passed_to = roughplastic_transmittance(m, r_after(to.z, passed));
    const real chance = roughplastic_chance(m, passed), chance_to = roughplastic_chance(m, r_after(passed_to, chance));
    const real pdf = chance * coat_pdf + (R(1) - chance) * warp_cosine_hemisphere_pdf(to.z);
    const real pdf_reverse = chance_to * density / area_to + (R(1) - chance_to) * warp_cosine_hemisphere_pdf(from.z);
    terms.pdf = is_valid ? pdf : R(0);
    terms.pdf_reverse = is_valid ? pdf_reverse : R(0);
    const real inverse = terms.pdf > R(0) ? R(1) / r_max(pdf, R(1e-30)) : R(0);
    const rgb of_coat = rgb_scale(material_specular_reflectance(m), coat * inverse);
    const rgb of_base = rgb_scale(coat_base(m), passed * passed_to * warp_cosine_hemisphere_pdf(to.z) * inverse);
    terms.weight = rgb_add(of_coat, of_base);
    return terms;
}

GRADUS_FN bsdf_sample roughplastic_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int distribution) {
    bsdf_sample sample;
    const vec3 from = v3(wi.x, wi.y, r_abs(wi.z));
    /* Written as in roughplastic_terms, so that what both compute from wi is computed once. */
    const real alpha_u = microfacet_alpha(m.alpha_u);
    const real alpha_v = microfacet_alpha(r_after(m.alpha_v, alpha_u));
    const vec3 normal = microfacet_sample_visible(distribution, from, alpha_u, alpha_v, u1, u2);
    const vec3 mirrored = v3_mad(v3_neg(from), R(2) * v3_dot(from, normal), normal);
    const vec3 scattered = warp_cosine_hemisphere(u1, r_after(u2, mirrored.z));
    const real chance = roughplastic_chance(m, roughplastic_transmittance(m, from.z));
    sample.wo = v3_select(u_lobe < chance, mirrored, scattered);
    const bsdf_terms terms = roughplastic_terms(m, wi, sample.wo, distribution);
    sample.weight = terms.weight;
    sample.pdf = terms.pdf;
    sample.pdf_reverse = terms.pdf_reverse;
    sample.eta = R(1);
    sample.is_specular = 0;
    return sample;
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
