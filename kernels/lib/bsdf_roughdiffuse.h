/* A surface of diffuse facets, one-sided (Oren and Nayar 1994): their model of single and double scattering (eqs. 27 to
 * 30), or their simpler one without interreflection (`fast_approximation`). Mitsuba 0.x: the deviation of the facets'
 * slopes is sqrt(1/2) of its parameter alpha, here `facet_alpha`. Sampled by the cosine.
 *
 * With a the larger and b the smaller of both angles, s the squared deviation, and the azimuth phi between both
 * directions, of which only cos phi is needed:
 *   fast   A + B max(0, cos phi) sin a tan b
 *   full   r (C1 + cos phi C2 tan b + (1 - |cos phi|) C3 tan((a + b) / 2)) + r^2 (C4 - C4 cos phi (2 b / pi)^2). */
#ifndef GRADUS_LIB_BSDF_ROUGHDIFFUSE_H
#define GRADUS_LIB_BSDF_ROUGHDIFFUSE_H
#include "kernels/lib/approximation.h"
#include "kernels/lib/bsdf_sample.h"
#include "kernels/lib/ordered.h"
#include "kernels/lib/warp.h"

GRADUS_LIB_BEGIN

/* value = r single + r^2 twice, times cos / pi. */
typedef struct {
    real single, twice;
    GRADUS_NOT_IN_REGISTERS
} roughdiffuse_shares;

/* Both directions above the horizon. */
GRADUS_FN roughdiffuse_shares roughdiffuse_shares_of(material m, vec3 wi, vec3 wo) {
    const real s = R(0.5) * m.facet_alpha * m.facet_alpha;
    const real tiny = R(1e-12);
    /* a is the angle of the lower direction. */
    const real cos_a = r_min(wi.z, wo.z), cos_b = r_max(r_after(wi.z, cos_a), wo.z);
    const real wi_squared = wi.x * wi.x + wi.y * wi.y;
    const real sine_i = r_sqrt(wi_squared);
    const real wo_squared = r_after(wo.x * wo.x, sine_i) + wo.y * wo.y;
    const real sine_o = r_sqrt(wo_squared);
    const real sin_a = r_max(sine_i, sine_o), sin_b = r_min(r_after(sine_i, sin_a), sine_o);
    const real cos_phi = r_clamp((wi.x * wo.x + wi.y * wo.y) / r_max(sine_i * sine_o, tiny), R(-1), R(1));
    const real tan_b = sin_b / r_max(r_after(cos_b, cos_phi), tiny);
    const real a_slope = R(1) - R(0.5) * s / (s + R(0.33));
    const real share = s / (r_after(s, a_slope) + R(0.09));
    const real fast = a_slope + R(0.45) * share * r_max(cos_phi, R(0)) * sin_a * tan_b;

    const real angle_a = approx_acos_unit(r_after(cos_a, fast)), angle_b = approx_acos_unit(r_after(cos_b, angle_a));
    const real of_pi = R(2) * GRADUS_INV_PI * angle_b;
    const real product = R(2) * GRADUS_INV_PI * angle_a * of_pi;
    const real c2 = R(0.45) * share * (cos_phi > R(0) ? sin_a : sin_a - of_pi * of_pi * of_pi);
    const real c3 = R(0.125) * share * product * product;
    const real c4 = R(0.17) * s / (r_after(s, share) + R(0.13));
    /* tan((a + b) / 2) = (sin a + sin b) / (cos a + cos b) */
    const real tan_half = (r_after(sin_a, tan_b) + sin_b) / r_max(r_after(cos_a, tan_b) + cos_b, tiny);
    const real full = a_slope + cos_phi * c2 * tan_b + (R(1) - r_abs(cos_phi)) * c3 * tan_half;
    const int is_fast = m.fast_approximation > R(0.5);
    roughdiffuse_shares shares;
    shares.single = is_fast ? fast : full;
    shares.twice = is_fast ? R(0) : c4 * (R(1) - cos_phi * of_pi * of_pi);
    return shares;
}

GRADUS_FN bsdf_terms roughdiffuse_terms(material m, vec3 wi, vec3 wo) {
    bsdf_terms terms;
    const int is_valid = (wi.z > R(0)) & (wo.z > R(0));
    terms.pdf = is_valid ? warp_cosine_hemisphere_pdf(wo.z) : R(0);
    terms.pdf_reverse = is_valid ? warp_cosine_hemisphere_pdf(wi.z) : R(0);
    const real from_z = r_abs(wi.z), to_z = r_abs(r_after(wo.z, from_z));
    const roughdiffuse_shares shares = roughdiffuse_shares_of(m, v3(wi.x, wi.y, from_z), v3(wo.x, wo.y, to_z));
    const real once = is_valid ? r_max(shares.single, R(0)) : R(0), twice = is_valid ? shares.twice : R(0);
    /* One after the other: kernels/lib/ordered.h. */
    const real red = m.reflectance_r * (once + m.reflectance_r * twice);
    const real albedo_g = r_after(m.reflectance_g, red);
    const real green = albedo_g * (once + albedo_g * twice);
    const real albedo_b = r_after(m.reflectance_b, green);
    terms.weight = rgb3(red, green, albedo_b * (once + albedo_b * twice));
    return terms;
}

GRADUS_FN bsdf_value roughdiffuse_evaluate(material m, vec3 wi, vec3 wo, int mode) {
    (void)mode;
    return bsdf_value_of(roughdiffuse_terms(m, wi, wo));
}

GRADUS_FN bsdf_sample roughdiffuse_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode) {
    (void)u_lobe, (void)mode;
    const vec3 wo = warp_cosine_hemisphere(u1, u2);
    return bsdf_sample_of(wo, roughdiffuse_terms(m, wi, wo));
}

GRADUS_FN rgb roughdiffuse_albedo(material m) { return material_reflectance(m); }

GRADUS_LIB_END
#endif
