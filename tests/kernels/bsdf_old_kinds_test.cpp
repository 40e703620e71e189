// The BSDFs of Mitsuba 0.x against their papers' formulas, written with angles.
#include "tests/kernels/bsdf_case.h"
#include "tests/support/quadrature.h"

#include <gtest/gtest.h>
#include <random>

using namespace gradus::testing;

namespace {

struct Angles {
    double theta, phi;
};

Angles angles_of(lib::vec3 w) { return {std::acos(std::min(1.0, double(w.z))), std::atan2(double(w.y), double(w.x))}; }

/// Oren and Nayar 1994, eqs. 27 to 30, over pi; sigma in radians of slope.
double oren_nayar(double albedo, double sigma, Angles i, Angles o) {
    const double s = sigma * sigma, a = std::max(i.theta, o.theta), b = std::min(i.theta, o.theta);
    const double cosine = std::cos(o.phi - i.phi), of_pi = 2 * b / M_PI;
    const double c1 = 1 - 0.5 * s / (s + 0.33);
    const double c2 = 0.45 * s / (s + 0.09) * (std::sin(a) - (cosine >= 0 ? 0 : std::pow(of_pi, 3)));
    const double c3 = 0.125 * s / (s + 0.09) * std::pow(4 * a * b / (M_PI * M_PI), 2);
    const double once = c1 + cosine * c2 * std::tan(b) + (1 - std::fabs(cosine)) * c3 * std::tan(0.5 * (a + b));
    const double twice = 0.17 * s / (s + 0.13) * (1 - cosine * of_pi * of_pi);
    return (albedo * once + albedo * albedo * twice) / M_PI;
}

/// The same, eq. 30: the simple model.
double oren_nayar_fast(double albedo, double sigma, Angles i, Angles o) {
    const double s = sigma * sigma, a = std::max(i.theta, o.theta), b = std::min(i.theta, o.theta);
    return albedo / M_PI *
           (1 - 0.5 * s / (s + 0.33) +
            0.45 * s / (s + 0.09) * std::max(0.0, std::cos(o.phi - i.phi)) * std::sin(a) * std::tan(b));
}

double ward(int variant, double alpha_u, double alpha_v, lib::vec3 wi, lib::vec3 wo) {
    const double h[] = {double(wi.x) + wo.x, double(wi.y) + wo.y, double(wi.z) + wo.z};
    const double length = std::hypot(h[0], h[1], h[2]), delta = std::acos(std::min(1.0, h[2] / length));
    const double phi = std::atan2(h[1], h[0]);
    const double slopes = std::pow(std::cos(phi) / alpha_u, 2) + std::pow(std::sin(phi) / alpha_v, 2);
    const double lobe = std::exp(-std::pow(std::tan(delta), 2) * slopes) / (M_PI * alpha_u * alpha_v);
    const double cosines = double(wi.z) * wo.z;
    return lobe * (variant == 0   ? 1 / (4 * std::sqrt(cosines))
                   : variant == 1 ? 1 / (4 * cosines)
                                  : 1 / (length * length * std::pow(std::cos(delta), 4)));
}

/// Calls visit(material, wi, wo) for pairs above the horizon.
template <class Visit>
void for_pairs(Visit visit) {
    std::mt19937_64 random(31);
    for (int n = 0; n < 20'000; ++n) {
        lib::material m = coloured_material(0.1 + 0.6 * double(draw(random)), 0.1 + 0.6 * double(draw(random)));
        m.facet_alpha = draw(random);
        m.fast_approximation = R(n % 2);
        m.exponent = R(1) + R(60) * draw(random);
        m.ward_variant = R(n % 3);
        lib::vec3 wi = draw_direction(random), wo = draw_direction(random);
        wi.z = std::fabs(wi.z), wo.z = std::fabs(wo.z);
        if (std::min(wi.z, wo.z) > R(0.02))
            visit(m, wi, wo);
    }
}

} // namespace

TEST(BsdfOldKinds, RoughDiffuseIsOrenAndNayars) {
    const Kind &kind = kind_named("roughdiffuse");
    for_pairs([&](const lib::material &m, lib::vec3 wi, lib::vec3 wo) {
        const double sigma = m.facet_alpha * std::sqrt(0.5);
        const auto f = m.fast_approximation != 0 ? oren_nayar_fast : oren_nayar;
        const double expected = f(m.reflectance_g, sigma, angles_of(wi), angles_of(wo)) * wo.z;
        ASSERT_NEAR(kind.eval(m, wi, wo).g, expected, bound(1e-5, 1e-12));
    });
}

TEST(BsdfOldKinds, PhongIsTheModifiedOne) {
    const Kind &kind = kind_named("phong");
    for_pairs([&](const lib::material &m, lib::vec3 wi, lib::vec3 wo) {
        const double cosine = std::max(0.0, double(wi.z) * wo.z - double(wi.x) * wo.x - double(wi.y) * wo.y);
        const double lobe = m.specular_reflectance_g * (m.exponent + 2) / (2 * M_PI) * std::pow(cosine, m.exponent);
        const double expected = (m.reflectance_g / M_PI + lobe) * wo.z;
        ASSERT_NEAR(kind.eval(m, wi, wo).g, expected, bound(3e-5, 1e-12) * std::max(1.0, expected));
    });
    // At normal incidence the lobe reflects just its colour: the integral of (n + 2) / (2 pi) cos^(n + 1).
    lib::material m = coloured_material(1, 1);
    const double power = integrate_adaptively(
        [&](double cosine, double) {
            const auto sine = real(std::sqrt(1 - cosine * cosine));
            return 2 * M_PI * kind.eval(m, lib::v3(0, 0, 1), lib::v3(sine, 0, real(cosine))).g;
        },
        0, 1, 0, 1, 1e-6);
    EXPECT_NEAR(power, m.reflectance_g + m.specular_reflectance_g, 1e-5);
}

TEST(BsdfOldKinds, PhongIsRightForHighExponents) {
    const Kind &kind = kind_named("phong");
    lib::material m = coloured_material(1, 1);
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> uniform;
    for (const double exponent : {1e5, 1e7, 1e8}) {
        m.exponent = real(exponent);
        double most = 0;
        for (int i = 0; i < 1000; ++i) {
            const lib::vec3 wi = draw_direction(random);
            if (std::fabs(wi.z) < R(0.1))
                continue;
            // Within a few widths of the lobe of the mirror direction.
            const auto beside = [&] { return (2 * uniform(random) - 1) * 2 / std::sqrt(exponent); };
            const double x = -wi.x + beside(), y = -wi.y + beside(), z = std::fabs(double(wi.z)) + beside();
            const double length = std::hypot(x, y, z);
            const lib::vec3 from = lib::v3(wi.x, wi.y, std::fabs(wi.z)),
                            to = lib::v3(real(x / length), real(y / length), real(z / length));
            const double apart = std::hypot(double(to.x) + from.x, double(to.y) + from.y, double(to.z) - from.z);
            const double lobe = (exponent + 2) / (2 * M_PI) * std::exp(exponent * std::log1p(-apart * apart / 2));
            const double expected = (m.reflectance_g / M_PI + m.specular_reflectance_g * lobe) * to.z;
            most = std::max(most, std::fabs(kind.eval(m, from, to).g - expected) / std::max(1.0, expected));
        }
        // Directions are known to 1e-7, and the lobe is 1 / sqrt(exponent) wide.
        EXPECT_LE(most, bound(6e-3, 1e-10)) << exponent;
    }
}

TEST(BsdfOldKinds, WardIsEachOfItsVariants) {
    const Kind &kind = kind_named("ward");
    for_pairs([&](const lib::material &m, lib::vec3 wi, lib::vec3 wo) {
        const double lobe = ward(int(m.ward_variant), m.alpha_u, m.alpha_v, wi, wo);
        const double expected = (m.reflectance_g / M_PI + m.specular_reflectance_g * lobe) * wo.z;
        ASSERT_NEAR(kind.eval(m, wi, wo).g, expected, bound(1e-4, 1e-11) * std::max(1.0, expected));
    });
}
