// Chi-square of every sampler against the integral of its pdf per cell. The samples that fail (below the horizon, for
// one) are a cell too, whose expectation is what the pdf leaves of 1: so the pdf also integrates to what it should.
#include "tests/kernels/bsdf_case.h"
#include "tests/kernels/direction_chart.h"
#include "tests/support/chi_square.h"
#include "tests/support/quadrature.h"

#include <cstdio>
#include <gtest/gtest.h>
#include <random>

using namespace gradus::testing;

namespace {

constexpr int resolution = 20; // cells along each axis of a chart
/// The double build has the same formulas: what it is tried for are constants and functions of its own.
constexpr int samples_of_case = sample_count / (is_double ? 8 : 4);

LobeCharts charts_of(const BsdfCase &test) {
    const bool rough = is_rough(test.kind);
    return lobe_charts(test.wi, is_dielectric(test.kind) ? test.material.ior : 1.0,
                       rough ? std::min(test.material.alpha_u, test.material.alpha_v) : 1.0);
}

/// Counts of samples by cell, [hemisphere][q][turn], and the failed ones last.
std::vector<double> count_samples(const BsdfCase &test, const LobeCharts &charts, int samples) {
    std::mt19937_64 random(20261121);
    std::vector<double> counts(2 * resolution * resolution + 1);
    const auto cell = [](double x) { return std::clamp(static_cast<int>(x * resolution), 0, resolution - 1); };
    for (int i = 0; i < samples; ++i) {
        const real u_lobe = draw(random), u1 = draw(random), u2 = draw(random);
        const lib::bsdf_sample sample = test.kind.sample(test.material, test.wi, u_lobe, u1, u2);
        if (sample.pdf == 0 || sample.is_specular) { // Dirac lobes are what the density leaves of 1, too
            counts.back() += 1;
            continue;
        }
        const bool is_upper = sample.wo.z >= 0;
        const auto point = charts.of(is_upper).to_square(sample.wo.x, sample.wo.y, sample.wo.z);
        counts[(is_upper * resolution + cell(point.q)) * resolution + cell(point.turn)] += 1;
    }
    return counts;
}

std::vector<double> integrate_pdf(const BsdfCase &test, const LobeCharts &charts, double scale) {
    std::vector<double> expected(2 * resolution * resolution + 1);
    double whole = 0;
    for (int side = 0; side < 2; ++side)
        for (int i = 0; i < resolution; ++i)
            for (int j = 0; j < resolution; ++j) {
                const auto pdf = [&](double q, double turn) {
                    const auto d = charts.of(side).to_direction(q, turn);
                    return d.jacobian * test.kind.pdf(test.material, test.wi, lib::v3(real(d.x), real(d.y), real(d.z)));
                };
                const double mass = integrate_adaptively(pdf, i / double(resolution), (i + 1) / double(resolution),
                                                         j / double(resolution), (j + 1) / double(resolution), 3e-7, 7);
                expected[(side * resolution + i) * resolution + j] = scale * mass;
                whole += mass;
            }
    expected.back() = scale * std::max(0.0, 1 - whole);
    return expected;
}

} // namespace

TEST(DirectionChart, CoversTheSphereAndInvertsItself) {
    const LobeCharts charts = lobe_charts(direction(70, 20), 1.5, 0.05);
    for (const bool is_upper : {true, false}) {
        const auto &chart = charts.of(is_upper);
        const double area = integrate_adaptively(
            [&](double q, double turn) { return chart.to_direction(q, turn).jacobian; }, 0, 1, 0, 1, 1e-7);
        EXPECT_NEAR(area, 2 * M_PI, 1e-6);
        for (const double q : {0.01, 0.3, 0.7, 0.99})
            for (const double turn : {0.01, 0.4, 0.77}) {
                const auto d = chart.to_direction(q, turn);
                EXPECT_NEAR(std::hypot(d.x, d.y, d.z), 1, 1e-12);
                EXPECT_EQ(d.z > 0, is_upper);
                const auto back = chart.to_square(d.x, d.y, d.z);
                EXPECT_NEAR(back.q, q, 1e-9);
                EXPECT_NEAR(back.turn, turn, 1e-9);
            }
    }
}

TEST(BsdfSampling, FollowsItsPdfForEveryKindRoughnessAndIncidence) {
    const std::vector<BsdfCase> cases = bsdf_cases();
    const double level = sidak_level(1e-3, static_cast<int>(cases.size()));
    double smallest = 1;
    for (const BsdfCase &test : cases) {
        const LobeCharts charts = charts_of(test);
        const auto counts = count_samples(test, charts, samples_of_case);
        const auto expected = integrate_pdf(test, charts, samples_of_case);
        const ChiSquare result = chi_square(counts, expected);
        smallest = std::min(smallest, result.p_value);
        EXPECT_GT(result.p_value, level) << test.name << ": chi-square " << result.statistic << " with "
                                         << result.degrees_of_freedom << " degrees of freedom, " << counts.back()
                                         << " failed samples of " << expected.back() << " expected";
        EXPECT_GT(result.degrees_of_freedom, 10) << test.name;
    }
    std::printf("  %zu cases, smallest p-value %.3g, level %.3g\n", cases.size(), smallest, level);
}

TEST(BsdfSampling, NoticesAPdfThatBelongsToAnotherRoughness) {
    // The power of the test: a few percent of roughness must not pass.
    const std::vector<BsdfCase> cases = bsdf_cases();
    BsdfCase test = *std::find_if(cases.rbegin(), cases.rend(), [](const BsdfCase &other) {
        return std::string(other.kind.name) == "roughdielectric_beckmann";
    });
    const LobeCharts charts = charts_of(test);
    const auto counts = count_samples(test, charts, samples_of_case);
    test.material.alpha_u *= R(0.93);
    EXPECT_LT(chi_square(counts, integrate_pdf(test, charts, samples_of_case)).p_value, 1e-6);
}

TEST(BsdfSampling, DeltaKindsChooseTheirLobesByFresnel) {
    const Kind &kind = kind_named("dielectric");
    const lib::material m = white_material(1, 1, 1.5);
    for (const double angle : {0.0, 60.0, 85.0, 100.0, 150.0}) {
        const lib::vec3 wi = direction(angle, 10);
        const double eta = wi.z > 0 ? 1.5 : 1 / 1.5;
        const double reflectance = lib::fresnel_dielectric(std::fabs(wi.z), real(eta)).reflectance;
        for (const double u : {0.0, 0.02, 0.3, 0.6, 0.99}) {
            const lib::bsdf_sample sample = kind.sample(m, wi, real(u), 0, 0);
            const bool is_reflected = sample.wo.z * wi.z > 0;
            EXPECT_EQ(is_reflected, u < reflectance);
            EXPECT_NEAR(sample.pdf, is_reflected ? reflectance : 1 - reflectance, 1e-6);
            EXPECT_NEAR(lib::v3_length_squared(sample.wo), 1, 1e-6);
            const double ratio = is_reflected ? 1 : eta; // Snell's law: the tangent scales by the index ratio
            EXPECT_NEAR(sample.wo.x * ratio, -wi.x, 1e-6);
            EXPECT_NEAR(sample.wo.y * ratio, -wi.y, 1e-6);
            EXPECT_NEAR(sample.eta, ratio, 1e-6);
            EXPECT_NEAR(sample.weight.g, 1 / (ratio * ratio), 1e-6);
        }
    }
}
