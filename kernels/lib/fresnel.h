/* Unpolarised Fresnel reflectances. */
#ifndef GRADUS_LIB_FRESNEL_H
#define GRADUS_LIB_FRESNEL_H
#include "kernels/lib/ordered.h"
#include "kernels/lib/vector.h"

GRADUS_LIB_BEGIN

/* What a smooth dielectric interface does to a ray. */
typedef struct {
    real reflectance;        /* in [0, 1]; 1 where reflection is total */
    real cosine_transmitted; /* cosine between the transmitted ray and the normal, >= 0; 0 where reflection is total */
    GRADUS_NOT_IN_REGISTERS
} fresnel_dielectric_result;

/* cosine: of the incident ray against the normal, in [0, 1]. eta: index on the transmitted side over that on the
 * incident side, > 0. Both amplitudes are written without differences of nearly equal terms:
 *   r_s = (1 - eta^2) / (c + eta c')^2,
 *   r_p = (eta^2 - 1)((eta^2 + 1) c^2 - 1) / (eta (eta c + c'))^2,  c'^2 = (c^2 + (eta - 1)(eta + 1)) / eta^2. */
GRADUS_FN fresnel_dielectric_result fresnel_dielectric(real cosine, real eta) {
    fresnel_dielectric_result result;
    const real contrast = (eta - R(1)) * (eta + R(1));
    const real squared = cosine * cosine + contrast; /* (eta c')^2 */
    const real root = r_sqrt(r_max(squared, R(0)));  /* eta c' */
    const real s_sum = cosine + root;
    const real p_sum = eta * eta * cosine + root; /* eta (eta c + c') */
    /* Both sums are 0 only for grazing light on equal indices, where nothing is reflected. */
    const real tiny = R(1e-18);
    const real s_amplitude = contrast / r_max(s_sum * s_sum, tiny);
    const real p_amplitude = contrast * ((eta * eta + R(1)) * cosine * cosine - R(1)) / r_max(p_sum * p_sum, tiny);
    const real reflectance = R(0.5) * (s_amplitude * s_amplitude + p_amplitude * p_amplitude);
    result.reflectance = squared > R(0) ? r_min(reflectance, R(1)) : (contrast < R(0) ? R(1) : R(0));
    result.cosine_transmitted = root / eta;
    return result;
}

/* Reflectance at normal incidence on a dielectric interface. */
GRADUS_FN real fresnel_at_normal(real eta) {
    const real root = (eta - R(1)) / (eta + R(1));
    return root * root;
}

/* One channel of a conductor, index eta + i k relative to the outside; cosine in [0, 1]. Exact (Born and Wolf,
 * Principles of Optics, 14.2), with a^2 + b^2 and the smaller of a^2, b^2 formed without cancellation.
 * eta = 0, k = 1 reflects everything. */
GRADUS_FN real fresnel_conductor(real cosine, real eta, real k) {
    const real tiny = R(1e-30);
    const real cosine_squared = cosine * cosine;
    /* Not 0, where nothing would be left of eta = 0, k = 0. */
    const real sine_squared = r_max(R(1) - cosine_squared, R(1e-20));
    /* (a + i b)^2 = (eta + i k)^2 - sin^2 */
    const real re = (eta - k) * (eta + k) - sine_squared;
    const real half_im = eta * k;
    const real modulus = r_sqrt(re * re + R(4) * half_im * half_im);
    const real larger = R(0.5) * (modulus + r_abs(re));
    const real smaller = half_im * half_im / r_max(larger, tiny);
    const real a_squared = re < R(0) ? smaller : larger;
    const real b_squared = re < R(0) ? larger : smaller;
    const real a = r_sqrt(a_squared);
    const real s_minus = a - cosine;
    const real s_numerator = s_minus * s_minus + b_squared;
    const real s_plus = r_after(a, s_numerator) + cosine;
    const real s_denominator = s_plus * s_plus + b_squared;
    const real p_minus = r_after(a, s_denominator) * cosine - sine_squared;
    const real p_numerator = p_minus * p_minus + cosine_squared * b_squared;
    const real p_plus = r_after(a, p_numerator) * cosine + sine_squared;
    const real p_denominator = p_plus * p_plus + cosine_squared * b_squared;
    /* (r_s + r_p) / 2 with r_s = s_numerator / s_denominator, r_p = r_s p_numerator / p_denominator */
    return R(0.5) * s_numerator * (p_denominator + p_numerator) / r_max(s_denominator * p_denominator, tiny);
}

/* Rough mean of a reflectance over the cosine-weighted hemisphere from its value at normal incidence: Schlick's
 * (1994) curve integrates to f0 + (1 - f0) / 21. */
GRADUS_FN real fresnel_mean(real at_normal) { return at_normal + (R(1) - at_normal) * R(0.047619047619047619); }

GRADUS_LIB_END
#endif
