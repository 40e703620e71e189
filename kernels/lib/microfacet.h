/* Microfacet distributions: anisotropic GGX and Beckmann with separable Smith masking (Walter et al. 2007, Heitz
 * 2014), and sampling of the visible normals.
 *
 * Local frame: z is the geometric normal of the microsurface. Every direction v here is a unit vector with v.z >= 0.
 * All follows from the projected area of the visible microfacets,
 *     sigma(v) = integral over m of D(m) max(v . m, 0) = v.z / G1(v),
 * which stays finite and positive at grazing v, where G1 and v.z both vanish. */
#ifndef GRADUS_LIB_MICROFACET_H
#define GRADUS_LIB_MICROFACET_H
#include "kernels/lib/approximation.h"
#include "kernels/lib/ordered.h"
#include "kernels/lib/vector.h"

GRADUS_LIB_BEGIN

/* A compile-time constant wherever it is passed, so that inlining leaves one distribution only. */
enum microfacet_distribution { microfacet_ggx, microfacet_beckmann };

/* Roughness below 1e-4 is taken as 1e-4, as in Mitsuba. */
GRADUS_FN real microfacet_alpha(real alpha) { return r_max(alpha, R(1e-4)); }

/* D(m) by solid angle of m, for m = h / |h|. h need not be normalised, h.z >= 0: the squared tangent comes from
 * h.x and h.y, never from 1 - m.z^2. length_squared = |h|^2. 0 for h = 0. */
GRADUS_FN real microfacet_density(int distribution, vec3 h, real length_squared, real alpha_u, real alpha_v) {
    const real slope_u = h.x / alpha_u;
    const real slope_v = h.y / r_after(alpha_v, slope_u);
    const real slope_squared = slope_u * slope_u + slope_v * slope_v;
    const real z_squared = h.z * h.z;
    const real norm = GRADUS_INV_PI / (alpha_u * alpha_v);
    const real tiny = R(1e-30);
    const real ggx_ratio = length_squared / r_max(slope_squared + z_squared, tiny);
    const real ggx = ggx_ratio * ggx_ratio;
    /* Where 1 / cos^2 exceeds its bound the exponential is 0. */
    const real z_guarded = r_max(z_squared, tiny);
    const real inverse_cosine_squared = r_min(length_squared / z_guarded, R(1e8));
    const real beckmann = approx_exp(-slope_squared / z_guarded) * inverse_cosine_squared * inverse_cosine_squared;
    return norm * (distribution == microfacet_ggx ? ggx : beckmann);
}

/* sigma(v) = v.z / G1(v), unitless. GGX: (z + sqrt(z^2 + a^2)) / 2; Beckmann: z (1 + erf(z/a)) / 2 +
 * a exp(-z^2/a^2) / (2 sqrt(pi)), which is z and what the integral of its tail adds; a = |(alpha_u v.x, alpha_v v.y)|.
 */
GRADUS_FN real microfacet_projected_area(int distribution, vec3 v, real alpha_u, real alpha_v) {
    const real x = alpha_u * v.x;
    const real y = alpha_v * r_after(v.y, x);
    const real a_squared = x * x + y * y;
    const real ggx = R(0.5) * (v.z + r_sqrt(v.z * v.z + a_squared));
    const real a = r_sqrt(a_squared);
    const real beckmann = v.z + a * approx_gauss_excess(v.z * (R(1) / r_max(a, R(1e-15))));
    return distribution == microfacet_ggx ? ggx : beckmann;
}

/* A visible normal of GGX from its hemisphere configuration: the spherical cap of reflected directions (Dupuy and
 * Benyoub 2023). Unit vector with z >= 0. */
GRADUS_FN vec3 microfacet_sample_ggx(vec3 wi, real alpha_u, real alpha_v, real u1, real u2) {
    const vec3 w = v3_normalize(v3(alpha_u * wi.x, alpha_v * wi.y, wi.z));
    /* The cap is z in (-w.z, 1]; both 1 - z and 1 + z without cancellation, also for w near the pole. */
    const real one_minus_z = u1 * (R(1) + w.z);
    const real one_plus_z = (R(1) - u1) * (R(1) + w.z) + (w.x * w.x + w.y * w.y) / (R(1) + w.z);
    const real radius = r_sqrt(one_minus_z * one_plus_z);
    const sine_cosine turn = approx_sine_cosine_2pi(u2);
    const vec3 h =
        v3(alpha_u * (radius * turn.cosine + w.x), alpha_v * (radius * turn.sine + w.y), (R(1) - u1) * (R(1) + w.z));
    return v3_normalize(h);
}

#ifdef GRADUS_DOUBLE
#define GRADUS_BECKMANN_FACING R(1e-8)
#else
#define GRADUS_BECKMANN_FACING R(4e-4)
#endif

/* One Halley step towards the slope x whose cumulated visible area equals target. The cumulated area
 * z cdf(x) + a gauss(x) / (2 sqrt(pi)) grows from 0 to sigma as x runs from -infinity to z / a. */
GRADUS_FN real microfacet_beckmann_step(real x, gauss_cdf pair, real highest, real target, real z, real a) {
    /* The area ends in a double root: nearer to it than the root of the rounding error, the error is noise. */
    const real facing = r_max(z - x * a, GRADUS_BECKMANN_FACING * (z + a));
    const real error = z * pair.cdf + R(0.28209479177387814347) * a * pair.gauss - target;
    /* The derivative is gauss facing / sqrt(pi); 1e-7 exceeds gauss only beyond |x| = 4. Halley divides Newton's step
     * by 1 - error f'' / (2 f'^2), with f'' / f' = -2x - a / facing: all in one fraction. */
    const real numerator = R(1.77245385090551602730) * error;
    const real newton = r_max(pair.gauss, R(1e-7)) * facing * facing;
    const real halley = newton + numerator * (x * facing + R(0.5) * a);
    const real next = x - numerator * facing / r_clamp(halley, R(0.5) * newton, R(4) * newton);
    return r_clamp(next, R(-4), highest);
}

/* A visible normal of Beckmann: the slope along wi by inverting its cumulated area (Heitz and d'Eon 2014 give the
 * density), the slope across is gaussian. Unit vector with z > 0. */
GRADUS_FN vec3 microfacet_sample_beckmann(vec3 wi, real alpha_u, real alpha_v, real u1, real u2) {
    const real tiny = R(1e-15);
    /* As in microfacet_projected_area, which whoever evaluates the sample calls too: the compiler joins them. */
    const real x = alpha_u * wi.x, z = wi.z;
    const real y = alpha_v * r_after(wi.y, x);
    const real a_squared = x * x + y * y;
    const real a = r_sqrt(a_squared);
    const real inverse_a = R(1) / r_max(a, tiny);
    const real cosine_phi = a > tiny ? x * inverse_a : R(1);
    const real sine_phi = a > tiny ? y * inverse_a : R(0);
    const real highest = r_min(z * inverse_a, R(4));
    /* Start: at normal incidence the area is linear in cdf(x), at grazing it is nearly a parabola in it. */
    const gauss_cdf end = approx_gauss_tail_rough(highest);
    const real rest = R(1) - u1;
    const real blend = a / (a + z);
    const real missing = blend * r_sqrt(rest) + (R(1) - blend) * rest;
    const real below = (R(1) - end.cdf) * (R(1) - missing), above = end.cdf + (R(1) - end.cdf) * missing;
    real along = r_min(approx_inverse_erf_rough(below, above), highest);
    /* The first step knows the area roughly, and its end as roughly. It goes halfway to the end at most: there is no
     * way back from a double root. */
    gauss_cdf pair = approx_gauss_tail_rough(along);
    pair.cdf = along < R(0) ? pair.cdf : R(1) - pair.cdf;
    const real rough_area = z * (R(1) - end.cdf) + R(0.28209479177387814347) * a * end.gauss;
    along = microfacet_beckmann_step(along, pair, R(0.5) * (along + highest), u1 * rough_area, z, a);
    const real target = u1 * microfacet_projected_area(microfacet_beckmann, wi, alpha_u, alpha_v);
    along = microfacet_beckmann_step(along, approx_gauss_cdf(along), highest, target, z, a);
#ifdef GRADUS_DOUBLE
    along = microfacet_beckmann_step(along, approx_gauss_cdf(along), highest, target, z, a);
    along = microfacet_beckmann_step(along, approx_gauss_cdf(along), highest, target, z, a);
#endif
    const real across = approx_inverse_erf_unit(u2);
    const real slope_u = alpha_u * (along * cosine_phi - across * sine_phi);
    const real slope_v = alpha_v * (along * sine_phi + across * cosine_phi);
    return v3_normalize(v3(-slope_u, -slope_v, R(1)));
}

/* A visible normal m, with density D(m) max(wi . m, 0) / sigma(wi) by solid angle of m. */
GRADUS_FN vec3 microfacet_sample_visible(int distribution, vec3 wi, real alpha_u, real alpha_v, real u1, real u2) {
    /* Only one of the two is left once the constant is folded. */
    return distribution == microfacet_ggx ? microfacet_sample_ggx(wi, alpha_u, alpha_v, u1, u2)
                                          : microfacet_sample_beckmann(wi, alpha_u, alpha_v, u1, u2);
}

GRADUS_LIB_END
#endif
