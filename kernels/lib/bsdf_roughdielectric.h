/* A rough dielectric interface (Walter et al. 2007, eqs. 20 and 21), sampled by visible normals and then by Fresnel.
 * The normal points outside; ior is the index inside over the index outside.
 *
 * With eta = (index on wo's side) / (index on wi's side), 1 for reflection, and h = wi + eta wo, both lobes are
 *     pdf = P D(m) |wi.m| / sigma(wi)  eta^2 |wo.m| / |h|^2,   weight = G1(wo) (over eta^2 for transmitted radiance),
 * where P is Fresnel's R or 1 - R, for |wi.m + eta wo.m| = |h|. A path from below is turned by a point reflection,
 * which leaves D unchanged, so that wi is always above.
 *
 * Indices that differ by less than 1e-4 would make transmission a delta lobe: the ratio is then taken as 1.0001. */
#ifndef GRADUS_LIB_BSDF_ROUGHDIELECTRIC_H
#define GRADUS_LIB_BSDF_ROUGHDIELECTRIC_H
#include "kernels/lib/bsdf_dielectric.h"
#include "kernels/lib/microfacet_event.h"

GRADUS_LIB_BEGIN

/* Index below over index above, as seen by a path that comes from the given side (+1 or -1). */
GRADUS_FN real roughdielectric_eta(material m, real side) {
    const real ior = r_abs(m.ior - R(1)) < R(1e-4) ? R(1.0001) : m.ior;
    return side > R(0) ? ior : R(1) / ior;
}

GRADUS_FN bsdf_terms roughdielectric_terms(material m, vec3 wi, vec3 wo, int mode, int distribution) {
    bsdf_terms terms;
    const real alpha_u = microfacet_alpha(m.alpha_u), alpha_v = microfacet_alpha(m.alpha_v);
    const real side = r_copysign1(wi.z);
    const real eta_below = roughdielectric_eta(m, side);
    const vec3 from = v3_scale(wi, side), to = v3_scale(wo, side);
    const microfacet_crossing crossing = microfacet_crossing_of(from, to, eta_below);
    const int is_reflected = crossing.is_reflected;
    const real eta = crossing.eta;
    const real reflectance = fresnel_dielectric(r_clamp(crossing.from_cosine, R(0), R(1)), eta_below).reflectance;
    const real probability = is_reflected ? reflectance : R(1) - reflectance;
    const real density = microfacet_density(distribution, crossing.h, crossing.length_squared, alpha_u, alpha_v);
    const real area = microfacet_projected_area(distribution, from, alpha_u, alpha_v);
    const real pdf = probability * density * crossing.jacobian / area;
    const int is_valid = crossing.is_sided & (pdf > R(0));
    const vec3 above = v3(r_after(to.x, area), r_after(to.y, area), r_abs(to.z));
    const real area_to = microfacet_projected_area(distribution, above, alpha_u, alpha_v);
    const real masking = above.z / area_to;
    const real scale = mode == transport_radiance ? masking / (eta * eta) : masking;
    terms.weight =
        rgb_scale(rgb_select(is_reflected, material_specular_reflectance(m), material_specular_transmittance(m)),
                  is_valid ? scale : R(0));
    terms.pdf = is_valid ? pdf : R(0);
    /* The way back has the same half vector and the same P; its index ratio is 1 / eta, so its Jacobian lacks eta^2. */
    const real back = probability * density * crossing.jacobian / (eta * eta * area_to);
    terms.pdf_reverse = (is_valid & (from.z > R(0))) ? back : R(0);
    return terms;
}

GRADUS_FN bsdf_sample roughdielectric_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode,
                                             int distribution) {
    const real side = r_copysign1(wi.z);
    const real eta = roughdielectric_eta(m, side);
    const real inverse_eta = R(1) / eta;
    const vec3 from = v3_scale(wi, side);
    const vec3 normal =
        microfacet_sample_visible(distribution, from, microfacet_alpha(m.alpha_u), microfacet_alpha(m.alpha_v), u1, u2);
    const real cosine = r_clamp(v3_dot(from, normal), R(0), R(1));
    const fresnel_dielectric_result fresnel = fresnel_dielectric(cosine, eta);
    const int is_reflected = u_lobe < fresnel.reflectance;
    /* wo = along normal - from_scale from */
    const real along = is_reflected ? R(2) * cosine : cosine * inverse_eta - fresnel.cosine_transmitted;
    const real from_scale = is_reflected ? R(1) : inverse_eta;
    const vec3 to = v3_sub(v3_scale(normal, along), v3_scale(from, from_scale));
    const vec3 wo = v3_scale(to, side);
    const bsdf_terms terms = roughdielectric_terms(m, wi, wo, mode, distribution);
    /* The lobe that was chosen may leave on the wrong side: then there is no sample. */
    const int is_valid = (to.z > R(0)) == is_reflected;
    return bsdf_sample_if(is_valid, wo, terms, is_reflected ? R(1) : eta);
}

#define GRADUS_ROUGHDIELECTRIC(name, distribution)                                                                     \
    GRADUS_FN bsdf_value name##_evaluate(material m, vec3 wi, vec3 wo, int mode) {                                     \
        return bsdf_value_of(roughdielectric_terms(m, wi, wo, mode, distribution));                                    \
    }                                                                                                                  \
    GRADUS_FN bsdf_sample name##_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode) {                \
        return roughdielectric_sample(m, wi, u_lobe, u1, u2, mode, distribution);                                      \
    }                                                                                                                  \
    GRADUS_FN rgb name##_albedo(material m) { return dielectric_albedo(m); }
GRADUS_ROUGHDIELECTRIC(roughdielectric_ggx, microfacet_ggx)
GRADUS_ROUGHDIELECTRIC(roughdielectric_beckmann, microfacet_beckmann)
#undef GRADUS_ROUGHDIELECTRIC

GRADUS_LIB_END
#endif
