/* The principled BSDF of a thin surface (Burley 2015), as Mitsuba 3 has it: the same from both sides. Diffuse light is
 * shared between both sides by diff_trans (0 to 2), specular light by Fresnel; what is transmitted leaves as if it had
 * been reflected on the other side, off microfacets made rougher or smoother with the index. */
#ifndef GRADUS_LIB_BSDF_PRINCIPLEDTHIN_H
#define GRADUS_LIB_BSDF_PRINCIPLEDTHIN_H
#include "kernels/lib/ordered.h"
#include "kernels/lib/principled.h"

GRADUS_LIB_BEGIN

/* The microfacets of reflection, or those of transmission. */
GRADUS_FN principled_alpha principledthin_alpha(material m, int is_transmitted) {
    const real scale = is_transmitted ? R(0.65) * m.ior - R(0.35) : R(1);
    return principled_alpha_of(scale * m.roughness, m.anisotropic);
}

/* The chances to sample each lobe, whose sum is 1: specular ones by a guess of Fresnel's reflectance at wi. */
typedef struct {
    real mirrored, passed, diffuse, beyond;
    GRADUS_NOT_IN_REGISTERS
} principledthin_chances;

GRADUS_FN principledthin_chances principledthin_chances_of(material m, real cosine) {
    principledthin_chances chances;
    const real guess = principled_mix(fresnel_at_normal(m.ior), R(1), schlick_weight(cosine));
    const real share = r_clamp(guess, R(0.2), R(0.8));
    chances.mirrored = m.spec_trans * share;
    chances.passed = m.spec_trans * (R(1) - share);
    chances.beyond = (R(1) - m.spec_trans) * R(0.5) * m.diff_trans;
    chances.diffuse = (R(1) - m.spec_trans) * (R(1) - R(0.5) * m.diff_trans);
    return chances;
}

GRADUS_FN bsdf_terms principledthin_terms(material m, vec3 wi, vec3 wo, int mode) {
    bsdf_terms terms;
    const real side = r_copysign1(wi.z);
    const vec3 from = v3_scale(wi, side);
    const int is_reflected = wo.z * side > R(0);
    const vec3 to = v3(wo.x * side, wo.y * side, r_abs(wo.z)); /* as if reflected */
    const principled_alpha alpha = principledthin_alpha(m, !is_reflected);
    const vec3 h = v3_ordered(v3_add(from, to));
    const real length_squared = v3_dot(h, h);
    const real middle = r_min(R(0.5) * r_sqrt(length_squared), R(1));
    const fresnel_dielectric_result fresnel = fresnel_dielectric(middle, m.ior);
    const real density = R(0.25) * microfacet_density(microfacet_ggx, h, length_squared, alpha.u, alpha.v);
    const real facets = density / microfacet_projected_area(microfacet_ggx, from, alpha.u, alpha.v);
    const vec3 later = v3(r_after(to.x, facets), r_after(to.y, facets), to.z);
    const real area_to = microfacet_projected_area(microfacet_ggx, later, alpha.u, alpha.v);
    /* As in Mitsuba, what a microfacet passes on must leave behind that very one, too; so there, the way back is not
     * the same, and importance goes by the other direction. */
    const vec3 leaving = v3_select(mode == transport_radiance, to, from);
    const int is_behind = leaving.x * h.x + leaving.y * h.y < leaving.z * h.z;
    const real masked = (is_reflected | is_behind) ? m.spec_trans * facets * to.z / area_to : R(0);

    const rgb base = material_reflectance(m);
    const rgb tint = principled_tint(base);
    const real curve = principled_curve(middle, fresnel.cosine_transmitted, m.ior);
    const rgb tinted = principled_schlick(rgb_scale(tint, fresnel_at_normal(m.ior)), curve);
    const rgb mirrored = rgb_mix(rgb_gray(fresnel.reflectance), tinted, m.spec_tint);
    const rgb passed = rgb_scale(base, R(1) - fresnel.reflectance);
    const rgb specular = rgb_scale(rgb_select(is_reflected, mirrored, passed), masked);
    const real opaque = R(1) - m.spec_trans, half_passed = R(0.5) * m.diff_trans;
    const rgb scattered =
        rgb_add(rgb_scale(base, principled_diffuse(m, from.z, to.z, middle)), principled_sheen(m, tint, to.z, middle));
    const rgb above = rgb_scale(scattered, opaque * (R(1) - half_passed));
    const rgb beyond = rgb_scale(base, opaque * half_passed * warp_cosine_hemisphere_pdf(to.z));

    const principledthin_chances there = principledthin_chances_of(m, from.z);
    const principledthin_chances back = principledthin_chances_of(m, r_after(to.z, there.passed));
    const real cosine_pdf = warp_cosine_hemisphere_pdf(to.z), cosine_back = warp_cosine_hemisphere_pdf(from.z);
    const real facets_back = density / area_to;
    const real pdf = is_reflected ? there.mirrored * facets + there.diffuse * cosine_pdf
                                  : there.passed * facets + there.beyond * cosine_pdf;
    const real pdf_reverse = is_reflected ? back.mirrored * facets_back + back.diffuse * cosine_back
                                          : back.passed * facets_back + back.beyond * cosine_back;
    const int is_valid = (wi.z != R(0)) & (wo.z != R(0)) & (pdf > R(0));
    terms.pdf = is_valid ? pdf : R(0);
    terms.pdf_reverse = is_valid ? pdf_reverse : R(0);
    const rgb value = rgb_add(specular, rgb_select(is_reflected, above, beyond));
    terms.weight = rgb_scale(value, is_valid ? R(1) / r_max(pdf, R(1e-30)) : R(0));
    return terms;
}

GRADUS_FN bsdf_value principledthin_evaluate(material m, vec3 wi, vec3 wo, int mode) {
    return bsdf_value_of(principledthin_terms(m, wi, wo, mode));
}

GRADUS_FN bsdf_sample principledthin_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode) {
    const real side = r_copysign1(wi.z);
    const vec3 from = v3_scale(wi, side);
    const principledthin_chances chances = principledthin_chances_of(m, from.z);
    const int is_mirrored = u_lobe < chances.mirrored;
    const int is_specular = u_lobe < chances.mirrored + chances.passed;
    const int is_above = is_specular ? is_mirrored : u_lobe < chances.mirrored + chances.passed + chances.diffuse;
    const principled_alpha alpha = principledthin_alpha(m, !is_above);
    const vec3 normal = microfacet_sample_visible(microfacet_ggx, from, alpha.u, alpha.v, u1, u2);
    const vec3 mirrored = v3_mad(v3_neg(from), R(2) * v3_dot(from, normal), normal);
    const vec3 scattered = warp_cosine_hemisphere(u1, r_after(u2, mirrored.z));
    const vec3 to = v3_select(is_specular, mirrored, scattered);
    const vec3 wo = v3(to.x * side, to.y * side, is_above ? to.z * side : -to.z * side);
    const bsdf_terms terms = principledthin_terms(m, wi, wo, mode);
    /* A microfacet may mirror below the horizon: then there is no sample. */
    const int is_valid = to.z > R(0);
    return bsdf_sample_if(is_valid, wo, terms, R(1));
}

GRADUS_FN rgb principledthin_albedo(material m) {
    const rgb base = material_reflectance(m);
    const real interface = fresnel_mean(fresnel_at_normal(m.ior));
    return rgb_add(rgb_scale(base, R(1) - m.spec_trans * interface), rgb_gray(m.spec_trans * interface));
}

GRADUS_LIB_END
#endif
