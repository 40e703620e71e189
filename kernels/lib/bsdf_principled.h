/* The principled BSDF (Burley 2012, 2015) as Mitsuba 3 has it: a diffuse lobe with sheen, GGX between dielectric and
 * metal, which also transmits, and a clear coat on top. The normal points outside. From inside there is the dielectric
 * alone, and nothing where nothing is transmitted.
 *
 * Which lobe is sampled goes by rough guesses of what each reflects at wi. Of the microfacet lobe a visible normal is
 * sampled, then reflection or transmission by Fresnel: as in kernels/lib/bsdf_roughdielectric.h, whose forms these are.
 * The coat's normals are sampled by their projected area. */
#ifndef GRADUS_LIB_BSDF_PRINCIPLED_H
#define GRADUS_LIB_BSDF_PRINCIPLED_H
#include "kernels/lib/approximation.h"
#include "kernels/lib/ordered.h"
#include "kernels/lib/principled.h"

GRADUS_LIB_BEGIN

GRADUS_FN real principled_coat_alpha(material m) { return principled_mix(R(0.1), R(0.001), m.clearcoat_gloss); }

/* D of the coat's microfacets (Burley 2012, eq. 4: GTR of exponent 1) times pi, by the squared sine of the normal. */
GRADUS_FN real principled_coat_density(real alpha_squared, real sine_squared) {
    const real cosine_squared = R(1) - sine_squared;
    return (alpha_squared - R(1)) /
           (approx_log(alpha_squared) * r_max(sine_squared + alpha_squared * cosine_squared, R(1e-12)));
}

/* G1 of the coat, GGX of roughness 1/4. */
GRADUS_FN real principled_coat_visible(real cosine) {
    return R(2) * cosine / r_max(cosine + r_sqrt(R(0.0625) + R(0.9375) * cosine * cosine), R(1e-12));
}

/* The chances to sample each lobe, from a side and at a cosine to the normal. They add up to 1. */
typedef struct {
    real diffuse, coat, facets;
    GRADUS_NOT_IN_REGISTERS
} principled_chances;

GRADUS_FN principled_chances principled_chances_of(material m, real cosine, int is_front, real spec_trans) {
    principled_chances chances;
    const rgb base = material_reflectance(m);
    const real mean = (base.r + base.g + base.b) * R(0.33333333333333333);
    const real curve = schlick_weight(cosine);
    const real interface = r_max(principled_mix(fresnel_at_normal(m.ior), R(1), curve), R(0.1));
    const real through = (R(1) - m.metallic) * spec_trans;
    const real opaque = (R(1) - m.metallic) * (R(1) - spec_trans);
    const real facets = m.metallic * r_max(mean, R(0.1)) + (R(1) - m.metallic) * interface + through;
    const real diffuse = opaque * (mean + m.sheen * R(0.1));
    const real coat = m.clearcoat * principled_mix(R(0.04), R(1), curve);
    const real inverse = R(1) / (facets + diffuse + coat);
    chances.diffuse = is_front ? diffuse * inverse : R(0);
    chances.coat = is_front ? coat * inverse : R(0);
    chances.facets = is_front ? facets * inverse : R(1);
    return chances;
}

/* Indices that differ by less than 1e-3 are taken as that far apart: a ray that passes straight on has no half vector.
 */
GRADUS_FN real principled_ior(material m) { return r_abs(m.ior - R(1)) < R(1e-3) ? R(1.001) : m.ior; }

GRADUS_FN bsdf_terms principled_terms(material m, vec3 wi, vec3 wo, int mode, int is_clear) {
    bsdf_terms terms;
    const real spec_trans = is_clear ? m.spec_trans : R(0);
    const principled_alpha alpha = principled_alpha_of(m.roughness, m.anisotropic);
    const int is_front = wi.z > R(0);
    const real side = r_copysign1(wi.z);
    const real ior = principled_ior(m);
    const real eta_below = is_front ? ior : R(1) / ior;
    const vec3 from = v3_scale(wi, side), to = v3_scale(wo, side);
    const microfacet_crossing crossing = microfacet_crossing_of(from, to, eta_below);
    const int is_reflected = crossing.is_reflected;
    const real eta = crossing.eta;
    const real middle = r_clamp(crossing.from_cosine, R(0), R(1));
    const fresnel_dielectric_result fresnel = fresnel_dielectric(middle, eta_below);
    const real to_z = r_abs(to.z);
    const int is_sided = crossing.is_sided & (wi.z != R(0));

    /* The microfacets. */
    const real through = (R(1) - m.metallic) * spec_trans;
    const real transmitted = through * (R(1) - fresnel.reflectance);
    const real chance_inside = is_reflected ? fresnel.reflectance : R(1) - fresnel.reflectance;
    const real chance_outside = is_reflected ? R(1) - transmitted : transmitted;
    const real density =
        microfacet_density(microfacet_ggx, crossing.h, crossing.length_squared, alpha.u, alpha.v) * crossing.jacobian;
    const real facets = is_sided ? density / microfacet_projected_area(microfacet_ggx, from, alpha.u, alpha.v) : R(0);
    const vec3 above = v3(r_after(to.x, facets), r_after(to.y, facets), to_z);
    const real area_to = microfacet_projected_area(microfacet_ggx, above, alpha.u, alpha.v);
    const real facets_back = is_sided ? density / (eta * eta * area_to) : R(0);
    const real masked = facets * to_z / area_to;

    const rgb base = material_reflectance(m);
    const rgb tint = principled_tint(base);
    const real curve = principled_curve(middle, fresnel.cosine_transmitted, eta_below);
    const real plain = (R(1) - m.metallic) * (R(1) - m.spec_tint) * fresnel.reflectance;
    const rgb tinted = principled_schlick(rgb_scale(tint, fresnel_at_normal(eta_below)), curve);
    const rgb metal = principled_schlick(base, curve);
    const rgb outside = rgb_add(rgb_add(rgb_gray(plain), rgb_scale(metal, m.metallic)),
                                rgb_scale(tinted, (R(1) - m.metallic) * m.spec_tint));
    const rgb mirrored = rgb_select(is_front, outside, rgb_gray(through * fresnel.reflectance));
    const real root_r = r_sqrt(base.r), root_g = r_sqrt(r_after(base.g, root_r));
    const rgb root = rgb3(root_r, root_g, r_sqrt(r_after(base.b, root_g)));
    const real scale = mode == transport_radiance ? R(1) / (eta * eta) : R(1);
    const rgb refracted = rgb_scale(root, transmitted * scale);
    const rgb of_facets = rgb_scale(rgb_select(is_reflected, mirrored, refracted), masked);

    /* The clear coat and the diffuse lobe, in front alone. */
    const vec3 h = crossing.h;
    const real sine_squared = (h.x * h.x + h.y * h.y) * crossing.inverse_length * crossing.inverse_length;
    const real coat_alpha = principled_coat_alpha(m);
    const real coat_density = principled_coat_density(coat_alpha * coat_alpha, sine_squared) * GRADUS_INV_PI;
    const int is_coat = is_front & is_reflected & is_sided;
    const real coat_pdf =
        is_coat ? R(0.25) * coat_density * h.z * crossing.inverse_length / r_max(middle, R(1e-12)) : R(0);
    const real coat_from = principled_coat_visible(r_after(from.z, coat_pdf));
    const real coat_visible = coat_from * principled_coat_visible(r_after(to_z, coat_from));
    const real coat_curve = principled_mix(R(0.04), R(1), curve);
    const real of_coat = is_coat ? R(0.25) * m.clearcoat * coat_curve * coat_density * coat_visible * to_z : R(0);
    const real above_both = (is_front & is_reflected) ? R(1) : R(0);
    const real opaque = (R(1) - m.metallic) * (R(1) - spec_trans);
    const rgb diffuse = rgb_scale(base, opaque * principled_diffuse(m, from.z, to_z, middle));
    const real has_sheen = opaque > R(0) ? R(1) - m.metallic : R(0);
    const rgb sheen = rgb_scale(principled_sheen(m, tint, to_z, middle), has_sheen);
    const rgb of_base = rgb_scale(rgb_add(diffuse, sheen), above_both);

    /* Densities there and back: of refraction, the way back begins on the other side. */
    const principled_chances there = principled_chances_of(m, from.z, is_front, spec_trans);
    const int back_is_front = is_front == is_reflected;
    const principled_chances back = principled_chances_of(m, r_after(to_z, there.facets), back_is_front, spec_trans);
    const real pdf_facets = there.facets * facets * (is_front ? chance_outside : chance_inside);
    const real back_facets = back.facets * facets_back * (back_is_front ? chance_outside : chance_inside);
    const real in_front = above_both * GRADUS_INV_PI;
    const real pdf = pdf_facets + there.coat * coat_pdf + there.diffuse * in_front * to_z;
    const real pdf_reverse = back_facets + back.coat * coat_pdf + back.diffuse * in_front * from.z;
    const int is_valid =
        (is_front | (through > R(0))) & (is_clear | is_reflected) & (wi.z != R(0)) & (to.z != R(0)) & (pdf > R(0));
    const int is_back_valid = (back_is_front | (through > R(0))) & is_valid;
    terms.pdf = is_valid ? pdf : R(0);
    terms.pdf_reverse = is_back_valid ? pdf_reverse : R(0);
    const rgb value = rgb_add(rgb_add(of_facets, rgb_gray(of_coat)), of_base);
    terms.weight = rgb_scale(value, is_valid ? R(1) / r_max(pdf, R(1e-30)) : R(0));
    return terms;
}

GRADUS_FN bsdf_sample principled_sampled(material m, vec3 wi, real u_lobe, real u1, real u2, int mode, int is_clear) {
    const real spec_trans = is_clear ? m.spec_trans : R(0);
    const principled_alpha alpha = principled_alpha_of(m.roughness, m.anisotropic);
    const int is_front = wi.z > R(0);
    const real side = r_copysign1(wi.z);
    const real ior = principled_ior(m);
    const real eta = is_front ? ior : R(1) / ior;
    const real inverse_eta = R(1) / eta;
    const vec3 from = v3_scale(wi, side);
    const principled_chances chances = principled_chances_of(m, from.z, is_front, spec_trans);
    const vec3 facet = microfacet_sample_visible(microfacet_ggx, from, alpha.u, alpha.v, u1, u2);
    /* The coat's normal: the logarithm of what its density is over is uniform. */
    const real coat_alpha = principled_coat_alpha(m), coat_squared = coat_alpha * coat_alpha;
    const real spread = approx_exp(approx_log(coat_squared) * (R(1) - u1));
    const real cosine_squared = r_clamp((R(1) - spread) / (R(1) - coat_squared), R(0), R(1));
    const real sine_squared = r_clamp((spread - coat_squared) / (R(1) - coat_squared), R(0), R(1));
    const sine_cosine turn = approx_sine_cosine_2pi(r_after(u2, facet.z));
    const real sine = r_sqrt(sine_squared);
    const vec3 coat = v3(sine * turn.cosine, sine * turn.sine, r_sqrt(cosine_squared));
    const vec3 scattered = warp_cosine_hemisphere(u1, r_after(u2, coat.z));

    const int is_diffuse = u_lobe < chances.diffuse;
    const int is_coat = !is_diffuse & (u_lobe < chances.diffuse + chances.coat);
    const vec3 normal = v3_select(is_coat, coat, facet);
    const real cosine = v3_dot(from, normal);
    const fresnel_dielectric_result fresnel = fresnel_dielectric(r_clamp(cosine, R(0), R(1)), eta);
    const real through = (R(1) - m.metallic) * spec_trans;
    const real transmitted = (is_front ? through : is_clear ? R(1) : R(0)) * (R(1) - fresnel.reflectance);
    /* What is left of the lobe's number is uniform again. */
    const real left = (u_lobe - chances.diffuse - chances.coat) / r_max(chances.facets, R(1e-6));
    const int is_refracted = !is_diffuse & !is_coat & (left > R(1) - transmitted);
    const real along = is_refracted ? cosine * inverse_eta - fresnel.cosine_transmitted : R(2) * cosine;
    const real from_scale = is_refracted ? inverse_eta : R(1);
    const vec3 turned = v3_sub(v3_scale(normal, along), v3_scale(from, from_scale));
    const vec3 to = v3_select(is_diffuse, scattered, turned);
    const vec3 wo = v3_scale(to, side);
    const bsdf_terms terms = principled_terms(m, wi, wo, mode, is_clear);
    /* The lobe that was chosen may leave on the wrong side: then there is no sample. */
    const int is_valid = ((to.z < R(0)) == is_refracted) & (cosine > R(0));
    return bsdf_sample_if(is_valid, wo, terms, is_refracted ? eta : R(1));
}

GRADUS_FN rgb principled_albedo_of(material m) {
    const rgb base = material_reflectance(m);
    const real interface = fresnel_mean(fresnel_at_normal(m.ior));
    const rgb dielectric = rgb_add(rgb_scale(base, R(1) - interface), rgb_gray(interface));
    return rgb_mix(dielectric, base, m.metallic);
}

/* is_clear: light passes it, by spec_trans; what does not is cheaper by half. */
#define GRADUS_PRINCIPLED_KIND(name, is_clear)                                                                         \
    GRADUS_FN bsdf_value name##_evaluate(material m, vec3 wi, vec3 wo, int mode) {                                     \
        return bsdf_value_of(principled_terms(m, wi, wo, mode, is_clear));                                             \
    }                                                                                                                  \
    GRADUS_FN bsdf_sample name##_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode) {                \
        return principled_sampled(m, wi, u_lobe, u1, u2, mode, is_clear);                                              \
    }                                                                                                                  \
    GRADUS_FN rgb name##_albedo(material m) { return principled_albedo_of(m); }
GRADUS_PRINCIPLED_KIND(principled, 0)
GRADUS_PRINCIPLED_KIND(principled_clear, 1)
#undef GRADUS_PRINCIPLED_KIND

GRADUS_LIB_END
#endif
