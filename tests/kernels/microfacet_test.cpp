// The microfacet identities that masking and sampling stand on, by quadrature.
#include "tests/kernels/bsdf_case.h"
#include "tests/support/quadrature.h"
#include "tests/support/worse.h"

#include <gtest/gtest.h>

using namespace gradus::testing;

namespace {

constexpr int distributions[] = {lib::microfacet_ggx, lib::microfacet_beckmann};

/// Integral over the normals m of D(m) weight(m). The substitution tan(theta) = alpha-sized t / (1 - t), per azimuth
/// on the ellipse of the two roughnesses, resolves D for every roughness.
template <class Weight>
double integrate_normals(int distribution, double alpha_u, double alpha_v, Weight weight) {
    const auto integrand = [&](double t, double turn) {
        const double r = t / (1 - t), r_per_t = 1 / ((1 - t) * (1 - t));
        const double x = alpha_u * r * std::cos(2 * M_PI * turn), y = alpha_v * r * std::sin(2 * M_PI * turn);
        const double length = std::sqrt(1 + x * x + y * y);
        const lib::vec3 m = lib::v3(real(x / length), real(y / length), real(1 / length));
        // d omega = cos^3 dx dy in slopes
        const double solid_angle = alpha_u * alpha_v * r * r_per_t * 2 * M_PI / (length * length * length);
        return solid_angle * weight(m) *
               lib::microfacet_density(distribution, m, lib::v3_dot(m, m), real(alpha_u), real(alpha_v));
    };
    return integrate(integrand, 0, 1, 0, 1, 48);
}

} // namespace

TEST(Microfacet, ProjectedAreaOfAllNormalsIsOne) {
    for (const int distribution : distributions)
        for (const auto &[u, v] : {std::pair{1.0, 1.0}, {0.3, 0.3}, {0.05, 0.4}, {1e-3, 1e-3}, {1e-4, 1e-4}})
            EXPECT_NEAR(integrate_normals(distribution, u, v, [](lib::vec3 m) { return double(m.z); }), 1,
                        bound(2e-6, 1e-9))
                << distribution << " " << u << " " << v;
}

TEST(Microfacet, VisibleAreaMatchesItsClosedForm) {
    for (const int distribution : distributions)
        for (const auto &[u, v] : {std::pair{1.0, 1.0}, {0.3, 0.3}, {0.05, 0.4}, {0.01, 0.01}})
            for (const double angle : {0.0, 30.0, 60.0, 85.0, 89.5, 90.0}) {
                const lib::vec3 wi = direction(angle, 25);
                const double visible = integrate_normals(
                    distribution, u, v, [&](lib::vec3 m) { return std::max(0.0, double(lib::v3_dot(m, wi))); });
                const double closed = lib::microfacet_projected_area(distribution, wi, real(u), real(v));
                // The integrand has a kink at the horizon of the microfacets.
                EXPECT_NEAR(visible / closed, 1, 1e-3) << distribution << " " << u << " " << v << " " << angle;
            }
}

TEST(Microfacet, DensityIgnoresTheLengthOfTheHalfVector) {
    for (const int distribution : distributions)
        for (const double angle : {0.0, 1.0, 30.0, 80.0}) {
            const lib::vec3 m = direction(angle, 70), h = lib::v3_scale(m, R(0.03125));
            const real unit = lib::microfacet_density(distribution, m, 1, R(0.2), R(0.4));
            const real scaled = lib::microfacet_density(distribution, h, R(0.0009765625), R(0.2), R(0.4));
            EXPECT_NEAR(scaled, unit, bound(1e-5, 1e-12) * unit);
        }
}

TEST(Microfacet, BeckmannSlopesInvertTheirCumulatedArea) {
    // With the slope across at its middle, the normal gives back the slope along wi, whose cumulated visible area
    // must be u1: at normal incidence, at grazing, and in between.
    double worst = 0;
    for (const double angle : {0.0, 0.1, 5.0, 20.0, 45.0, 55.0, 63.0, 70.0, 80.0, 85.0, 89.5, 89.99, 90.0})
        for (int i = 0; i < 20'000; ++i) {
            const real u1 = static_cast<real>((i + 0.5) / 20'000);
            const lib::vec3 wi = direction(angle, 0);
            const lib::vec3 m = lib::microfacet_sample_beckmann(wi, 1, 1, u1, R(0.5));
            const double slope = -double(m.x) / m.z, sine = std::fabs(wi.x), cosine = wi.z;
            const auto cumulated = [&](double x) {
                return cosine * 0.5 * std::erfc(-x) + sine * std::exp(-x * x) / (2 * std::sqrt(M_PI));
            };
            const double whole = sine > 0 ? cumulated(cosine / sine) : cosine;
            worst = worse(worst, std::fabs(cumulated(slope) / whole - u1));
        }
    std::printf("  largest error of the cumulated area: %.3g\n", worst);
    // Slopes end at 4 deviations of sqrt(1/2): 7.7e-9 of the area is given up on purpose.
    EXPECT_LE(worst, bound(4e-6, 1e-8));
}

TEST(Microfacet, SampledNormalsAreVisibleUnitVectors) {
    for (const int distribution : distributions)
        for (const double alpha : {1e-4, 0.01, 0.3, 1.0})
            for (const double angle : {0.0, 45.0, 89.0, 89.99, 90.0})
                for (const double u1 : {0.0, 1e-6, 0.25, 0.5, 0.9, 1 - 1e-6})
                    for (const double u2 : {0.0, 1e-6, 0.3, 0.5, 0.999999}) {
                        const lib::vec3 wi = direction(angle, 200);
                        const lib::vec3 m = lib::microfacet_sample_visible(distribution, v3_scale(wi, 1), real(alpha),
                                                                           real(alpha / 2), real(u1), real(u2));
                        EXPECT_NEAR(lib::v3_length_squared(m), 1, bound(5e-7, 1e-14));
                        EXPECT_GE(m.z, 0);
                        EXPECT_GE(lib::v3_dot(m, wi), -bound(1e-6, 1e-8));
                    }
}
