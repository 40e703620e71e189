// Fresnel reflectances against values derived by hand and against complex arithmetic.
#include "tests/kernels/precision.h"

#include <complex>
#include <gtest/gtest.h>

using namespace gradus::testing;

namespace {

constexpr double fresnel_tolerance = bound(3e-7, 1e-14);

/// The textbook amplitudes in complex arithmetic: n relative index, Snell's law with a complex angle.
double reflectance_by_complex_numbers(long double cosine, std::complex<long double> n) {
    const std::complex<long double> c(cosine, 0), transmitted = std::sqrt(1.0L - (1.0L - c * c) / (n * n));
    const auto s = (c - n * transmitted) / (c + n * transmitted), p = (n * c - transmitted) / (n * c + transmitted);
    return static_cast<double>(0.5L * (std::norm(s) + std::norm(p)));
}

} // namespace

TEST(FresnelDielectric, HandDerivedValues) {
    for (const double eta : {1.0 / 2.4, 1 / 1.5, 1.1, 1.5, 2.4}) {
        const double normal = std::pow((eta - 1) / (eta + 1), 2);
        EXPECT_NEAR(lib::fresnel_dielectric(1, real(eta)).reflectance, normal, fresnel_tolerance) << eta;
        EXPECT_NEAR(lib::fresnel_dielectric(1, real(eta)).cosine_transmitted, 1, fresnel_tolerance) << eta;
        EXPECT_NEAR(lib::fresnel_dielectric(0, real(eta)).reflectance, 1, fresnel_tolerance) << eta;
        // Brewster's angle, tan = eta: the p amplitude is 0, the s amplitude (1 - eta^2) / (1 + eta^2).
        const double brewster = 1 / std::sqrt(1 + eta * eta), s = (1 - eta * eta) / (1 + eta * eta);
        EXPECT_NEAR(lib::fresnel_dielectric(real(brewster), real(eta)).reflectance, 0.5 * s * s, fresnel_tolerance)
            << eta;
    }
}

TEST(FresnelDielectric, TotalReflectionBeyondTheCriticalAngleOnly) {
    const double eta = 1 / 1.5, critical = std::sqrt(1 - eta * eta);
    for (const double cosine : {0.0, 0.1, critical - 1e-3}) {
        EXPECT_EQ(lib::fresnel_dielectric(real(cosine), real(eta)).reflectance, 1);
        EXPECT_EQ(lib::fresnel_dielectric(real(cosine), real(eta)).cosine_transmitted, 0);
    }
    EXPECT_LT(lib::fresnel_dielectric(real(critical + 1e-3), real(eta)).reflectance, 0.9);
}

TEST(FresnelDielectric, EqualIndicesReflectNothing) {
    for (const double cosine : {0.0, 1e-20, 1e-6, 0.5, 1.0}) {
        EXPECT_EQ(lib::fresnel_dielectric(real(cosine), 1).reflectance, 0);
        EXPECT_NEAR(lib::fresnel_dielectric(real(cosine), 1).cosine_transmitted, double(real(cosine)), 1e-15);
    }
}

TEST(FresnelDielectric, MatchesComplexArithmeticAndIsSymmetric) {
    for (const real eta : {R(0.4), R(0.7), R(0.999), R(1.001), R(1.33), R(1.5), R(2.4)})
        for (int i = 0; i <= 1000; ++i) {
            const real cosine = static_cast<real>(i / 1000.0);
            const auto result = lib::fresnel_dielectric(cosine, eta);
            const double square = (double(eta) - 1) * (double(eta) + 1) + double(cosine) * cosine;
            if (std::fabs(square) < 1e-5)
                continue; // at the critical angle the slope is infinite
            // Ten roundings of half an ULP reach an amplitude's square; the condition number of the square root in it
            // grows as the critical angle comes near.
            const double allowed = fresnel_tolerance * (2 + 1 / std::sqrt(std::fabs(square)));
            ASSERT_NEAR(result.reflectance, reflectance_by_complex_numbers(cosine, {eta, 0}), allowed)
                << eta << " " << cosine;
            if (result.reflectance < 1) {
                if (cosine < R(1e-3))
                    continue;
                const auto back = lib::fresnel_dielectric(result.cosine_transmitted, 1 / eta);
                // The way back finds cosine^2 as eta^2 times a difference that is rounded to 2.4e-7 or so, and F
                // falls by 2 (1 + eta^2) / sqrt(eta^2 - 1) per unit of a small cosine.
                const double n = eta, slope = 2 * (1 + n * n) / std::sqrt(std::fabs((n - 1) * (n + 1)));
                const double slip = bound(2.4e-7, 5e-16) * n * n / (2 * cosine);
                ASSERT_NEAR(back.reflectance, result.reflectance, 4 * allowed + slope * slip) << eta << " " << cosine;
            }
        }
}

TEST(FresnelConductor, HandDerivedValues) {
    for (const auto &[eta, k] : {std::pair{0.2, 3.9}, {1.4, 7.6}, {2.0, 0.5}, {0.05, 4.2}}) {
        const double normal = ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
        EXPECT_NEAR(lib::fresnel_conductor(1, real(eta), real(k)), normal, fresnel_tolerance);
        EXPECT_NEAR(lib::fresnel_conductor(0, real(eta), real(k)), 1, fresnel_tolerance);
    }
}

TEST(FresnelConductor, PerfectMirrorAtEveryAngle) {
    for (const real k : {R(0), R(1)})
        for (int i = 0; i <= 1000; ++i)
            ASSERT_NEAR(lib::fresnel_conductor(real(i / 1000.0), 0, k), 1, bound(3e-7, 1e-15)) << k << " at " << i;
}

TEST(FresnelConductor, MatchesComplexArithmetic) {
    for (const real eta : {R(0.05), R(0.2), R(1), R(1.5), R(4)})
        for (const real k : {R(0), R(1e-3), R(0.1), R(1), R(4), R(10)})
            for (int i = 1; i <= 1000; ++i) {
                const real cosine = static_cast<real>(i / 1000.0);
                const long double critical = 1 - static_cast<long double>(cosine) * cosine -
                                             static_cast<long double>(eta) * eta + static_cast<long double>(k) * k;
                const double away = std::sqrt(static_cast<double>(std::hypot(critical, 2.0L * eta * k)));
                ASSERT_NEAR(lib::fresnel_conductor(cosine, eta, k), reflectance_by_complex_numbers(cosine, {eta, k}),
                            fresnel_tolerance * (2 + 1 / (away + 1e-7)))
                    << eta << " " << k << " " << cosine;
            }
}

TEST(FresnelConductor, WithoutAbsorptionIsADielectric) {
    for (int i = 1; i <= 100; ++i) {
        const real cosine = static_cast<real>(i / 100.0);
        EXPECT_NEAR(lib::fresnel_conductor(cosine, R(1.5), 0), lib::fresnel_dielectric(cosine, R(1.5)).reflectance,
                    fresnel_tolerance);
    }
}

TEST(FresnelMean, IsTheCosineWeightedMeanOfSchlicksCurve) {
    const double f0 = 0.3;
    double mean = 0;
    const int count = 100'000;
    for (int i = 0; i < count; ++i) {
        const double cosine = (i + 0.5) / count;
        mean += 2 * cosine * (f0 + (1 - f0) * std::pow(1 - cosine, 5)) / count;
    }
    EXPECT_NEAR(lib::fresnel_mean(real(f0)), mean, 1e-7);
}
