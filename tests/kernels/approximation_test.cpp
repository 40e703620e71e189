// The largest errors that kernels/lib/approximation.h states, on dense samples and at the edges.
#include "tests/kernels/precision.h"
#include "tests/support/worse.h"

#include <cstdio>
#include <gtest/gtest.h>
#include <limits>

using namespace gradus::testing;

namespace {

/// |value - exact| in units in the last place of a float at exact; the double build is measured in double's units.
double error_in_ulp(real value, long double exact) {
    const double magnitude = std::max(std::fabs(static_cast<double>(exact)), 1e-37);
    const int digits = is_double ? 52 : 23;
    const double unit = std::ldexp(1.0, std::ilogb(magnitude) - digits);
    return static_cast<double>(std::fabs(static_cast<long double>(value) - exact)) / unit;
}

template <class Function, class Exact>
double worst_ulp(Function function, Exact exact, double low, double high, int count = 400'000) {
    double worst = 0, where = low;
    for (int i = 0; i <= count; ++i) {
        const real x = static_cast<real>(low + (high - low) * i / count);
        const double error = error_in_ulp(function(x), exact(static_cast<long double>(x)));
        if (!(error <= worst)) {
            worst = error;
            where = static_cast<double>(x);
        }
    }
    std::printf("  largest error in [%g, %g]: %.2f ULP at %.9g\n", low, high, worst, where);
    return worst;
}

} // namespace

TEST(Approximation, ExponentialWithinTwoUlp) {
    const auto exact = [](long double x) { return std::exp(x); };
    EXPECT_LE(worst_ulp(lib::approx_exp, exact, -87, 88), 2);
    EXPECT_LE(worst_ulp(lib::approx_exp, exact, -1, 1), 2);
    EXPECT_EQ(lib::approx_exp(0), 1);
    EXPECT_EQ(lib::approx_exp(R(-1e30)), 0);
    EXPECT_EQ(lib::approx_exp(-std::numeric_limits<real>::infinity()), 0);
}

TEST(Approximation, LogarithmWithinTwoUlp) {
    const auto exact = [](long double x) { return std::log(x); };
    EXPECT_LE(worst_ulp(lib::approx_log, exact, 0.5, 2), 2);
    EXPECT_LE(worst_ulp(lib::approx_log, exact, 0.999, 1.001), 2);
    EXPECT_LE(worst_ulp(lib::approx_log, exact, 1e-7, 1e-3), 2);
    EXPECT_LE(worst_ulp(lib::approx_log, exact, 1, 1e6), 2);
    EXPECT_LE(error_in_ulp(lib::approx_log(std::numeric_limits<float>::min()), std::log(0x1p-126L)), 2);
    EXPECT_EQ(lib::approx_log(1), 0);
}

TEST(Approximation, SineAndCosineOfTurns) {
    double worst = 0;
    for (int i = 0; i <= 1 << 20; ++i) {
        const real u = static_cast<real>(std::ldexp(i, -20));
        const long double angle = 2 * 3.14159265358979323846264338327950288L * u;
        const lib::sine_cosine pair = lib::approx_sine_cosine_2pi(u);
        worst = std::max({worst, static_cast<double>(std::fabs(pair.sine - std::sin(angle))),
                          static_cast<double>(std::fabs(pair.cosine - std::cos(angle)))});
    }
    std::printf("  largest absolute error %.3g\n", worst);
    EXPECT_LE(worst, bound(1e-7, 5e-16));
    const real quarter[5][2] = {{0, 1}, {1, 0}, {0, -1}, {-1, 0}, {0, 1}};
    for (int i = 0; i <= 4; ++i) {
        const lib::sine_cosine pair = lib::approx_sine_cosine_2pi(R(0.25) * i);
        EXPECT_EQ(pair.sine, quarter[i][0]) << i;
        EXPECT_EQ(pair.cosine, quarter[i][1]) << i;
    }
}

TEST(Approximation, TurnsOfPoints) {
    double worst = 0, relative = 0;
    for (int i = 0; i < 1 << 20; ++i) {
        const long double angle = 2 * 3.14159265358979323846264338327950288L * std::ldexp(i, -20);
        const double distance = std::ldexp(1.0, i % 61 - 30);
        const real x = static_cast<real>(std::cos(angle) * distance), y = static_cast<real>(std::sin(angle) * distance);
        const long double turn = std::atan2(static_cast<long double>(y), static_cast<long double>(x)) /
                                 (2 * 3.14159265358979323846264338327950288L);
        const long double expected = turn < 0 ? turn + 1 : turn;
        const real found = lib::approx_turn(y, x);
        ASSERT_TRUE(found >= 0 && found <= 1);
        worst = worse(worst, static_cast<double>(std::fabs(found - expected)));
        if (expected > 0 && expected < 0.125L)
            relative = worse(relative, static_cast<double>(std::fabs(found / expected - 1)));
    }
    std::printf("  largest absolute error %.3g, relative near the axis %.3g\n", worst, relative);
    EXPECT_LE(worst, bound(6e-8, 3e-16));
    EXPECT_LE(relative, bound(2.5e-7, 6e-16));
    EXPECT_EQ(lib::approx_turn(0, 1), 0);
    EXPECT_EQ(lib::approx_turn(1, 0), R(0.25));
    EXPECT_EQ(lib::approx_turn(0, -1), R(0.5));
    EXPECT_EQ(lib::approx_turn(-1, 0), R(0.75));
    EXPECT_EQ(lib::approx_turn(0, 0), 0);
}

TEST(Approximation, GaussAndItsCumulatedKeepTheirTails) {
    for (int i = 0; i <= 400'000; ++i) {
        const real x = static_cast<real>(-4 + 8e0 * i / 400'000);
        const lib::gauss_cdf pair = lib::approx_gauss_cdf(x);
        const long double square = static_cast<long double>(x) * x, allowed = 8 + 2 * square;
        ASSERT_LE(error_in_ulp(pair.gauss, std::exp(-square)), allowed) << x;
        ASSERT_LE(error_in_ulp(pair.cdf, 0.5L * std::erfc(-static_cast<long double>(x))), allowed) << x;
    }
    for (const real x : {R(-50), R(-9), R(-4.2), R(4.2), R(9), R(50), R(1e18)}) {
        const lib::gauss_cdf pair = lib::approx_gauss_cdf(x);
        EXPECT_NEAR(pair.gauss, std::exp(-double(x) * x), bound(1.2e-7, 1e-15)) << x;
        EXPECT_NEAR(pair.cdf, 0.5 * std::erfc(-double(x)), bound(1.2e-7, 1e-15)) << x;
    }
}

TEST(Approximation, InverseErrorFunctionIsTheInverse) {
    // The error of y in ULP is judged through erf: dy = d(erf) sqrt(pi) / 2 exp(y^2).
    double worst = 0;
    for (int i = 1; i < 400'000; ++i) {
        const real u = static_cast<real>(i / 400'000.0);
        const long double y = lib::approx_inverse_erf_unit(u);
        const long double x = 2 * static_cast<long double>(u) - 1;
        if (x == 0) {
            EXPECT_EQ(y, 0);
            continue;
        }
        const long double residual = x < 0 ? std::erfc(-y) - (1 + x) : (1 - x) - std::erfc(y);
        const long double slip = residual * 0.886226925452758013649L * std::exp(y * y);
        worst = worse(worst, static_cast<double>(std::fabs(slip / y)));
    }
    std::printf("  largest relative error %.3g\n", worst);
    EXPECT_LE(worst, bound(4 * 1.2e-7, 1e-12));
    for (const real u : {R(0), R(1)})
        EXPECT_NEAR(std::fabs(lib::approx_inverse_erf_unit(u)), 3.93, 0.1);
    EXPECT_EQ(lib::approx_inverse_erf_unit(R(0.5)), 0);
}

TEST(Approximation, GaussExcessIsTheIntegralOfTheTail) {
    double worst = 0;
    for (int i = 0; i <= 100'000; ++i) {
        const real x = static_cast<real>(i * 1e-4);
        const long double y = x;
        const long double exact =
            std::exp(-y * y) * 0.28209479177387814347L - 0.5L * y * std::erfc(y); // beyond 5 both are nothing
        worst = worse(worst, double(std::fabs(lib::approx_gauss_excess(x) - exact) / (y + exact)));
    }
    std::printf("  largest error against x and the integral: %.3g\n", worst);
    // In float 4e-8 of the fit, and four roundings of 6e-8 where the polynomial is largest.
    EXPECT_LE(worst, bound(3e-7, 1e-15));
    EXPECT_LE(std::fabs(lib::approx_gauss_excess(R(1e15))), bound(2.2e-7, 1e-300));
}

TEST(Approximation, RoughFunctionsKeepToTheirBounds) {
    double gauss = 0, tail = 0, inverse = 0, step = 0;
    double before = 0;
    for (int i = 0; i <= 80'000; ++i) {
        const real x = static_cast<real>((i - 40'000) * 1e-4);
        const lib::gauss_cdf pair = lib::approx_gauss_tail_rough(x);
        const double exact = 0.5 * std::erfc(std::fabs(double(x)));
        gauss = std::max(gauss, std::fabs(pair.gauss / std::exp(-double(x) * x) - 1));
        tail = worse(tail, std::fabs(pair.cdf / exact - 1));
        // Smooth: the error of one place is nearly that of the next.
        const double slip = pair.cdf / exact;
        step = std::max(step, i == 0 ? 0.0 : std::fabs(slip - before));
        before = slip;
        const double u = 0.5 * std::erfc(-double(x));
        const double allowed = std::fabs(double(x)) < 3.5 ? 0.01 : 0.1;
        inverse =
            std::max(inverse, std::fabs(lib::approx_inverse_erf_rough(real(u), real(1 - u)) - double(x)) / allowed);
    }
    std::printf("  gauss %.2g, tail %.2g, from place to place %.2g, inverse %.2g\n", gauss, tail, step, inverse);
    EXPECT_LE(gauss, 4e-6);
    EXPECT_LE(tail, 3e-3);
    EXPECT_LE(step, 2e-5); // twice the error of gauss, and what the fit changes over 1e-4
    EXPECT_LE(inverse, 1);
}

#ifndef GRADUS_DOUBLE
TEST(Approximation, LogarithmWithoutADivisionHasAnAbsoluteError) {
    double worst = 0;
    for (int i = 0; i < 1'000'000; ++i) {
        const float x = std::exp2(float(i) * 2e-5f - 18);
        const double exact = std::log(double(x));
        worst = worse(worst, std::fabs(lib::approx_log_absolute(x) - exact) / std::max(1.0, std::fabs(exact)));
    }
    EXPECT_LE(worst, 1.6e-7); // 3.4e-8 of the fit, and two roundings
}
#endif
