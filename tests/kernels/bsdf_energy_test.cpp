// Energy: the mean weight of the samples is the integral of f |cos|, which never exceeds 1 for white materials.
#include "tests/kernels/bsdf_case.h"
#include "tests/kernels/direction_chart.h"
#include "tests/support/quadrature.h"

#include <gtest/gtest.h>
#include <random>

using namespace gradus::testing;

namespace {

struct Estimate {
    double mean, error; ///< error: standard error of the mean
    double dirac;       ///< by a Dirac lobe beside rough ones, which the mean leaves out
};

/// Mean weight with radiance's factor 1 / eta^2 taken out: the share of the power that leaves.
Estimate sampled_power(const BsdfCase &test, int samples) {
    std::mt19937_64 random(5);
    double sum = 0, squares = 0, dirac = 0;
    for (int i = 0; i < samples; ++i) {
        const real u_lobe = draw(random), u1 = draw(random), u2 = draw(random);
        const lib::bsdf_sample sample = test.kind.sample(test.material, test.wi, u_lobe, u1, u2);
        const double power = double(sample.weight.g) * sample.eta * sample.eta;
        if (sample.is_specular && !test.kind.is_delta) {
            dirac += power / samples;
            continue;
        }
        sum += power;
        squares += power * power;
    }
    const double mean = sum / samples;
    return {mean, std::sqrt(std::max(squares / samples - mean * mean, 0.0) / samples), dirac};
}

double integrated_power(const BsdfCase &test) {
    const bool dielectric = is_dielectric(test.kind);
    const double alpha = is_rough(test.kind) ? std::min(test.material.alpha_u, test.material.alpha_v) : 1.0;
    const LobeCharts charts = lobe_charts(test.wi, dielectric ? test.material.ior : 1.0, alpha);
    const double ior = dielectric ? test.material.ior : 1.0, eta = test.wi.z > 0 ? ior : 1 / ior;
    double sum = 0;
    for (const bool is_upper : {true, false}) {
        const double scale = is_upper == (test.wi.z > 0) ? 1 : eta * eta;
        const auto power = [&](double q, double turn) {
            const auto d = charts.of(is_upper).to_direction(q, turn);
            return scale * d.jacobian *
                   test.kind.eval(test.material, test.wi, lib::v3(real(d.x), real(d.y), real(d.z))).g;
        };
        const int cells = 24; // between 16 x 16 both rules miss a narrow lobe
        for (int i = 0; i < cells; ++i)
            for (int j = 0; j < cells; ++j)
                sum += integrate_adaptively(power, i / double(cells), (i + 1) / double(cells), j / double(cells),
                                            (j + 1) / double(cells), 1e-6);
    }
    return sum;
}

} // namespace

TEST(BsdfEnergy, SampledPowerIsTheIntegralOfEvalAndAtMostOne) {
    for (const BsdfCase &test : bsdf_cases()) {
        const Estimate sampled = sampled_power(test, sample_count / (is_double ? 8 : 4));
        const double integrated = integrated_power(test);
        // 4.5 standard errors (one case of all in a thousand runs), and what the quadrature leaves out.
        EXPECT_NEAR(sampled.mean, integrated, 4.5 * sampled.error + 1e-3) << test.name;
        // Two models make light of their own at grazing angles.
        const std::string name = test.kind.name;
        const double made = name.starts_with("principled") ? 0.11 : name == "roughdiffuse" ? 0.05 : 0;
        EXPECT_LE(integrated + sampled.dirac, 1 + made + 1e-3) << test.name;
        EXPECT_GT(integrated + sampled.dirac, 0.1) << test.name;
    }
}

TEST(BsdfEnergy, DiffuseReturnsItsAlbedo) {
    const Kind &kind = kind_named("diffuse");
    const lib::material m = coloured_material(1, 1);
    const lib::bsdf_sample sample = kind.sample(m, direction(30, 0), 0, R(0.7), R(0.2));
    EXPECT_EQ(sample.weight.r, m.reflectance_r);
    EXPECT_EQ(sample.weight.g, m.reflectance_g);
    EXPECT_EQ(sample.weight.b, m.reflectance_b);
    EXPECT_NEAR(kind.eval(m, direction(30, 0), direction(60, 90)).r, 0.7 * 0.5 / M_PI, 1e-7);
}

TEST(BsdfEnergy, MirrorsAndClearGlassLoseNothing) {
    for (const char *name : {"conductor", "dielectric", "thindielectric", "null"})
        for (const double angle : {0.0, 30.0, 60.0, 89.0, 120.0, 179.0}) {
            const Kind &kind = kind_named(name);
            if (std::string(name) == "conductor" && angle > 90)
                continue;
            const BsdfCase test{name, kind, white_material(1, 1), direction(angle, 50)};
            EXPECT_NEAR(sampled_power(test, 1000).mean, 1, bound(1e-6, 1e-12)) << name << " " << angle;
        }
}

TEST(BsdfEnergy, DielectricsWithEqualIndicesPassLightOn) {
    for (const Kind &kind : kinds) {
        if (!is_dielectric(kind) || has_many_lobes(kind))
            continue;
        for (const double angle : {0.0, 60.0, 89.0, 130.0}) {
            const lib::vec3 wi = direction(angle, 50);
            for (int i = 0; i < 100; ++i) {
                const lib::material m = white_material(0.1, 0.1, 1);
                const real u = static_cast<real>((i + 0.5) / 100.0);
                const lib::bsdf_sample sample = kind.sample(m, wi, u, R(0.3), R(0.8));
                if (kind.is_delta) {
                    ASSERT_EQ(sample.pdf, 1);
                    ASSERT_EQ(sample.weight.g, 1);
                }
                if (sample.pdf > 0 && std::fabs(wi.z) > R(0.1)) {
                    ASSERT_NEAR(lib::v3_dot(sample.wo, wi), -1, 1e-6) << kind.name;
                }
            }
        }
    }
}

TEST(BsdfEnergy, AlbedoIsCloseToTheReflectanceAtModerateRoughness) {
    // The estimate for denoisers is held to a tenth of the measured power at 45 degrees.
    for (const Kind &kind : kinds) {
        const BsdfCase test{kind.name, kind, coloured_material(0.15, 0.15), direction(45, 0)};
        const Estimate sampled = sampled_power(test, 20'000);
        EXPECT_NEAR(kind.albedo(test.material).g, sampled.mean + sampled.dirac, 0.1) << kind.name;
    }
}
