/* Branch-free sin, cos, atan2, exp, log, erf and inverse erf: straight polynomials that every CPU implementation of
 * OpenCL vectorises over work-items, where its own functions do not.
 *
 * The coefficients are our own minimax fits (Lawson iteration on Chebyshev nodes, fitted in double). Each function
 * states its domain and its largest error in the float build; tests/kernels/approximation_test.cpp holds them to it.
 * The double build is the reference: it calls the accurate built-ins. ULP: units in the last place of a float. */
#ifndef GRADUS_LIB_APPROXIMATION_H
#define GRADUS_LIB_APPROXIMATION_H
#include "kernels/shared/compat.h"

GRADUS_LIB_BEGIN

typedef struct {
    real sine, cosine;
    GRADUS_NOT_IN_REGISTERS
} sine_cosine;

/* The standard-normal-like pair that Beckmann microfacets need: gauss = exp(-x^2), cdf = (1 + erf(x)) / 2. */
typedef struct {
    real gauss, cdf;
    GRADUS_NOT_IN_REGISTERS
} gauss_cdf;

#ifdef GRADUS_DOUBLE
#ifdef __OPENCL_VERSION__
#define GRADUS_ACCURATE(function) function
#else
#define GRADUS_ACCURATE(function) std::function
#endif
#endif

/* exp(x) for x <= 88; 0 below -87. Error at most 2 ULP. */
GRADUS_FN real approx_exp(real x) {
#ifdef GRADUS_DOUBLE
    return GRADUS_ACCURATE(exp)(x);
#else
    const real clamped = r_clamp(x, R(-87), R(88));
    const real n = r_floor(clamped * R(1.4426950408889634) + R(0.5));
    /* ln 2 in two parts: n times the first is exact. */
    const real r = (clamped - n * R(0.693359375)) + n * R(2.12194440054690583e-4);
    real p = R(0.00139506003);
    p = p * r + R(0.008368953708);
    p = p * r + R(0.04166620417);
    p = p * r + R(0.166665183);
    p = p * r + R(0.5000000096);
    const real mantissa = R(1) + (r + r * r * p);
    const real power = as_float((uint)((int)n + 127) << 23);
    return x < R(-87) ? R(0) : mantissa * power;
#endif
}

/* log(x) for normal positive x. Error at most 2 ULP. */
GRADUS_FN real approx_log(real x) {
#ifdef GRADUS_DOUBLE
    return GRADUS_ACCURATE(log)(x);
#else
    /* x = 2^k (1 + f) with 1 + f in [sqrt(1/2), sqrt(2)): the shift moves the binade's border to sqrt(1/2). */
    const uint border = 0x3f3504f3u;
    const uint shifted = as_uint((float)x) + (0x3f800000u - border);
    const real k = (real)((int)(shifted >> 23) - 127);
    const real f = as_float((shifted & 0x007fffffu) + border) - R(1);
    /* log(1 + f) = 2 artanh(s), s = f / (2 + f), written as f - s (f - tail) so that f stays exact. */
    const real s = f / (R(2) + f);
    const real z = s * s;
    real p = R(0.2987459972);
    p = p * z + R(0.399774433);
    p = p * z + R(0.666667771);
    const real tail = z * p;
    return k * R(0.693359375) + ((f - s * (f - tail)) - k * R(2.12194440054690583e-4));
#endif
}

#ifndef GRADUS_DOUBLE
/* log(x) for normal positive x, without a division: absolute error at most 1.6e-7 max(1, |log x|). Float build only. */
GRADUS_FN real approx_log_absolute(real x) {
    const uint border = 0x3f3504f3u;
    const uint shifted = as_uint(x) + (0x3f800000u - border);
    const real k = (real)((int)(shifted >> 23) - 127);
    const real f = as_float((shifted & 0x007fffffu) + border) - R(1);
    real p = R(-0.101022368);
    p = p * f + R(0.1641998973);
    p = p * f + R(-0.1733346515);
    p = p * f + R(0.1987304644);
    p = p * f + R(-0.2495934384);
    p = p * f + R(0.3333618202);
    p = p * f + R(-0.500006674);
    p = p * f + R(0.9999998139);
    return k * R(0.69314718055994530942) + f * p;
}
#endif

/* sin(2 pi u) and cos(2 pi u), u in [0, 1]. Absolute error at most 1e-7; exact at multiples of 1/4. */
GRADUS_FN sine_cosine approx_sine_cosine_2pi(real u) {
    sine_cosine result;
    /* The nearest quarter turn and the exact rest, |rest| <= 1/8. */
    const real quarter = r_floor(R(4) * u + R(0.5));
    const real rest = u - R(0.25) * quarter;
    const real half_turns = r_floor(R(0.5) * quarter);
    const int is_odd = (quarter - R(2) * half_turns) > R(0.5);
#ifdef GRADUS_DOUBLE
#ifdef __OPENCL_VERSION__
    const real sine = sinpi(R(2) * rest), cosine = cospi(R(2) * rest);
#else
    const real sine = std::sin(R(2) * GRADUS_PI * rest), cosine = std::cos(R(2) * GRADUS_PI * rest);
#endif
#else
    const real z = rest * rest;
    real p = R(-75.39356271);
    p = p * z + R(81.59235355);
    p = p * z + R(-41.34166145);
    p = p * z + R(6.283185287);
    const real sine = rest * p;
    real q = R(59.24596185);
    q = q * z + R(-85.44374165);
    q = q * z + R(64.93932647);
    q = q * z + R(-19.73920869);
    const real cosine = R(1) + z * q;
#endif
    const real sine_of_quadrant = is_odd ? cosine : sine;
    const real cosine_of_quadrant = is_odd ? -sine : cosine;
    /* Half turns are 0, 1 or 2; 1 turns both signs. */
    const real sign = half_turns == R(1) ? R(-1) : R(1);
    result.sine = sign * sine_of_quadrant;
    result.cosine = sign * cosine_of_quadrant;
    return result;
}

/* The angle of the point (x, y) from the x axis on, towards y, in turns: atan2(y, x) / (2 pi), in [0, 1], whatever the
 * point's distance, if its square is a normal number; 0 at the origin. Relative error of the angle from the nearest
 * axis at most 2.5e-7, so an absolute one of at most 6e-8, the rounding near 1. */
GRADUS_FN real approx_turn(real y, real x) {
    /* Plus 0 times what goes before: or the pairs would be packed (kernels/lib/ordered.h). */
    const real width = r_abs(x), height = r_abs(y + R(0) * width);
    const real longer = r_max(width, height), shorter = r_min(width + R(0) * longer, height + R(0) * longer);
#ifdef GRADUS_DOUBLE
    const real eighth = longer > R(0) ? GRADUS_ACCURATE(atan2)(shorter, longer) * (R(0.5) * GRADUS_INV_PI) : R(0);
#else
    const real t = shorter / r_max(longer, R(1e-30));
    const real z = t * t;
    real p = R(0.0004535738199);
    p = p * z + R(-0.002557400924);
    p = p * z + R(0.00679456501);
    p = p * z + R(-0.01194345459);
    p = p * z + R(0.01693557197);
    p = p * z + R(-0.02260580213);
    p = p * z + R(0.031819242);
    p = p * z + R(-0.05305123391);
    p = p * z + R(0.1591549407);
    const real eighth = t * p;
#endif
    const real quarter = height > width ? R(0.25) - eighth : eighth;
    const real half_turn = x < R(0) ? R(0.5) - quarter : quarter;
    return y < R(0) ? R(1) - half_turn : half_turn;
}

/* The arc cosine of x in [0, 1]. Absolute error at most 2e-7 in float. */
GRADUS_FN real approx_acos_unit(real x) {
    real p = R(-0.001237004853);
    p = p * x + R(0.006580885238);
    p = p * x + R(-0.01696547196);
    p = p * x + R(0.03080825341);
    p = p * x + R(-0.05014502502);
    p = p * x + R(0.0889740993);
    p = p * x + R(-0.2145984942);
    p = p * x + R(1.570796302);
    const real angle = r_sqrt(r_max(R(1) - x, R(0))) * p;
#ifdef GRADUS_DOUBLE
    /* One step of Newton's brings the float fit to double accuracy. */
    const sine_cosine at = approx_sine_cosine_2pi(angle * (R(0.5) * GRADUS_INV_PI));
    return angle + (at.cosine - x) / r_max(at.sine, R(1e-30));
#else
    return angle;
#endif
}

/* exp(x^2) erfc(x) for x in [0, 4.1], the value at 4.1 beyond. Relative error at most 4 ULP. Float build only:
 * the double build has erf and erfc. */
#ifndef GRADUS_DOUBLE
GRADUS_FN real approx_scaled_erfc(real x) {
    const real t = R(1) / (R(1) + R(0.35) * r_min(x, R(4.1)));
    real p = R(-0.2144122073);
    p = p * t + R(0.8542545558);
    p = p * t + R(-0.8523481928);
    p = p * t + R(0.8804364367);
    p = p * t + R(-0.1393265306);
    p = p * t + R(0.2867829442);
    p = p * t + R(0.1837010782);
    p = p * t + R(0.0009118835346);
    return p;
}
#endif

/* exp(-x^2) and (1 + erf(x)) / 2. The relative error of both is at most (8 + 2 x^2) ULP for |x| <= 4, so the left
 * tail keeps its digits; the absolute error of both is at most 1.2e-7 for every x. */
GRADUS_FN gauss_cdf approx_gauss_cdf(real x) {
    gauss_cdf result;
    result.gauss = approx_exp(-x * x);
#ifdef GRADUS_DOUBLE
    result.cdf = R(0.5) * GRADUS_ACCURATE(erfc)(-x);
#else
    const real tail = R(0.5) * result.gauss * approx_scaled_erfc(r_abs(x));
    result.cdf = x < R(0) ? tail : R(1) - tail;
#endif
    return result;
}

/* What is left of gauss_cdf's Gaussian beyond |x|: exp(-x^2) and (1 - erf(|x|)) / 2, for |x| <= 4, with relative errors
 * of at most 4e-6 and 3e-3, both smooth in x but for 1e-5. For steps that a better one follows. */
GRADUS_FN gauss_cdf approx_gauss_tail_rough(real x) {
    gauss_cdf result;
#ifdef GRADUS_DOUBLE
    result.gauss = approx_exp(-x * x);
    result.cdf = R(0.5) * GRADUS_ACCURATE(erfc)(r_abs(x));
#else
    const real t = x * x * R(-1.4426950408889634);
    const real n = r_floor(t + R(0.5));
    const real r = t - n;
    real p = R(0.009570101792);
    p = p * r + R(0.05591786031);
    p = p * r + R(0.2402474483);
    p = p * r + R(0.6931218147);
    p = p * r + R(0.9999992614);
    result.gauss = p * as_float((uint)((int)n + 127) << 23);
    const real y = r_abs(x);
    real q = R(0.0005185367578);
    q = q * y + R(-0.008163665619);
    q = q * y + R(0.05303675603);
    q = q * y + R(-0.1862248667);
    q = q * y + R(0.3937214985);
    q = q * y + R(-0.5382956993);
    q = q * y + R(0.4987824485);
    result.cdf = result.gauss * q;
#endif
    return result;
}

/* The integral of (1 - erf) / 2 from x on, for x >= 0: exp(-x^2) / (2 sqrt(pi)) - x (1 - erf(x)) / 2 without the
 * cancellation. Error at most 3e-7 times x plus the integral in float. */
GRADUS_FN real approx_gauss_excess(real x) {
#ifdef GRADUS_DOUBLE
    const real y = r_min(x, R(30)); /* 0 beyond */
    return GRADUS_ACCURATE(exp)(-y * y) * R(0.28209479177387814347) - R(0.5) * y * GRADUS_ACCURATE(erfc)(y);
#else
    /* Beyond 3.3 it is less than 2.2e-7. */
    const real t = r_min(x, R(3.3)) - R(1.65);
    real p = R(6.363187782e-07);
    p = p * t + R(-3.959022913e-06);
    p = p * t + R(-6.220885136e-06);
    p = p * t + R(6.34324294e-05);
    p = p * t + R(-4.135695771e-05);
    p = p * t + R(-0.0003873208995);
    p = p * t + R(0.0009853740593);
    p = p * t + R(-7.391316336e-06);
    p = p * t + R(-0.005007624906);
    p = p * t + R(0.01373274511);
    p = p * t + R(-0.0203836869);
    p = p * t + R(0.01853672251);
    p = p * t + R(-0.009812754667);
    p = p * t + R(0.002346369065);
    return p;
#endif
}

/* The inverse of erf at x, with complement = (1 - x)(1 + x) given apart so that it may be exact near |x| = 1.
 * After Giles (2010), with coefficients of our own: x times a polynomial in w = -log(complement), or in its root. */
GRADUS_FN real approx_inverse_erf_from(real x, real complement) {
#ifdef GRADUS_DOUBLE
    const real w = -approx_log(complement);
#else
    const real w = -approx_log_absolute(complement);
#endif
    const real a = w - R(2.5);
    real p = R(2.8534789947414093e-08);
    p = p * a + R(3.437270596679544e-07);
    p = p * a + R(-3.528859549122514e-06);
    p = p * a + R(-4.396781252955276e-06);
    p = p * a + R(0.0002186021939583301);
    p = p * a + R(-0.0012537075153325344);
    p = p * a + R(-0.004177707744662328);
    p = p * a + R(0.2466407261211514);
    p = p * a + R(1.5014094215763258);
    const real b = r_sqrt(r_max(w, R(0))) - R(3);
    real q = R(-0.00016028231570126394);
    q = q * b + R(8.284972740553212e-05);
    q = q * b + R(0.0012929569372045807);
    q = q * b + R(-0.003656875840533019);
    q = q * b + R(0.005765207624084034);
    q = q * b + R(-0.007626155571264722);
    q = q * b + R(0.00943509053923972);
    q = q * b + R(1.0016742277279962);
    q = q * b + R(2.8329770028763193);
    return x * (w < R(5) ? p : q);
}

/* The inverse of erf at 2u - 1: sqrt(1/2) times the standard normal quantile of u. u in [0, 1]; u is moved into
 * [2^-26, 1 - 2^-26], so that the result lies within +-3.98. Relative error at most 4 ULP in float. */
GRADUS_FN real approx_inverse_erf_unit(real u) {
    const real smallest = R(1.4901161193847656e-08);
    const real lower = r_max(r_min(u, R(1) - u), smallest);
    const real start = approx_inverse_erf_from(R(1) - R(2) * lower, R(4) * lower * (R(1) - lower));
#ifdef GRADUS_DOUBLE
    /* Two Newton steps bring the float fit to double accuracy, on erfc in the tail and on erf near 0. */
    real y = start;
    for (int step = 0; step < 2; ++step) {
        const real error =
            lower < R(0.25) ? GRADUS_ACCURATE(erfc)(y) - R(2) * lower : (R(1) - R(2) * lower) - GRADUS_ACCURATE(erf)(y);
        y += error * R(0.88622692545275801365) * GRADUS_ACCURATE(exp)(y * y);
    }
#else
    const real y = start;
#endif
    return u < R(0.5) ? -y : y;
}

/* The same from u and 1 - u, both given, in few operations: a start for better steps. Absolute error at most 0.01, and
 * 0.1 at |x| = 4. */
GRADUS_FN real approx_inverse_erf_rough(real u, real one_minus_u) {
    const real complement = r_max(R(4) * u * one_minus_u, R(5.9604644775390625e-08));
#ifdef GRADUS_DOUBLE
    const real w = -approx_log(complement);
#else
    const uint border = 0x3f3504f3u;
    const uint shifted = as_uint(complement) + (0x3f800000u - border);
    const real k = (real)((int)(shifted >> 23) - 127);
    const real f = as_float((shifted & 0x007fffffu) + border) - R(1);
    real l = R(-0.2284819396);
    l = l * f + R(0.358710178);
    l = l * f + R(-0.5024652728);
    l = l * f + R(0.9993523284);
    const real w = -(k * R(0.69314718055994530942) + f * l);
#endif
    real p = R(-2.1118724e-06);
    p = p * w + R(9.8062165e-05);
    p = p * w + R(-0.00151177);
    p = p * w + R(0.0038288693);
    p = p * w + R(0.24763316);
    p = p * w + R(0.87884008);
    return (u - one_minus_u) * p;
}

GRADUS_LIB_END
#endif
