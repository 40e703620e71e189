// The way back and the two modes of transport: densities of exchanged directions, the adjoint, and what a sample says
// of the lobe that it came from.
#include "tests/kernels/bsdf_case.h"

#include <gtest/gtest.h>
#include <random>

using namespace gradus::testing;

namespace {

constexpr int modes[] = {lib::transport_radiance, lib::transport_importance};

/// Roughness 0.1 to 1, other along the second axis; glass and its inverse.
lib::material draw_material(std::mt19937_64 &random) {
    const double alpha = 0.1 + 0.9 * double(draw(random));
    return coloured_material(alpha, 0.5 * alpha + 0.05, draw(random) < R(0.5) ? 1.5 : 0.7);
}

/// A pair of directions, neither of them grazing: every other one is where the kind samples it, the rest is anywhere.
bool draw_pair(const Kind &kind, const lib::material &m, int i, std::mt19937_64 &random, lib::vec3 &wi, lib::vec3 &wo) {
    wi = draw_direction(random);
    const real u_lobe = draw(random), u1 = draw(random), u2 = draw(random);
    wo = i % 2 ? kind.sample(m, wi, u_lobe, u1, u2).wo : draw_direction(random);
    return std::min(std::fabs(wi.z), std::fabs(wo.z)) > R(0.02);
}

/// Both are computed from other half vectors, whose rounding D multiplies; the lobes of refraction end where wi.m = 0,
/// and the two sides round that end differently.
double tolerance(double a, double b) { return bound(1e-3, 1e-9) * std::max(a, b) + bound(3e-5, 1e-13); }

} // namespace

TEST(BsdfModes, ReverseDensityIsThatOfTheExchangedDirections) {
    std::mt19937_64 random(21);
    for (const Kind &kind : kinds) {
        if (kind.is_delta)
            continue;
        int found = 0;
        for (int i = 0; i < sample_count / 2; ++i) {
            const lib::material m = draw_material(random);
            lib::vec3 wi, wo;
            if (!draw_pair(kind, m, i, random, wi, wo))
                continue;
            const double reverse = kind.evaluate(m, wi, wo).pdf_reverse, back = kind.pdf(m, wo, wi);
            found += back > 1e-3;
            ASSERT_NEAR(reverse, back, tolerance(reverse, back)) << kind.name << " " << i;
            ASSERT_EQ(reverse, kind.evaluate(m, wi, wo, lib::transport_importance).pdf_reverse) << kind.name;
        }
        EXPECT_GT(found, sample_count / 20) << kind.name;
    }
}

TEST(BsdfModes, ImportanceIsTheAdjointOfRadiance) {
    // f of importance from wi to wo is f of radiance from wo to wi (Veach 1997, 5.2), without cosines.
    std::mt19937_64 random(22);
    for (const Kind &kind : kinds) {
        if (kind.is_delta)
            continue;
        int reflected = 0, transmitted = 0;
        for (int i = 0; i < sample_count / 2; ++i) {
            const lib::material m = draw_material(random);
            lib::vec3 wi, wo;
            if (!draw_pair(kind, m, i, random, wi, wo))
                continue;
            const double there = kind.evaluate(m, wi, wo, lib::transport_importance).value.g / std::fabs(double(wo.z));
            const double back = kind.evaluate(m, wo, wi, lib::transport_radiance).value.g / std::fabs(double(wi.z));
            (wi.z * wo.z > 0 ? reflected : transmitted) += there > 1e-3;
            ASSERT_NEAR(there, back, tolerance(there, back)) << kind.name << " " << i;
        }
        EXPECT_GT(reflected, sample_count / 100) << kind.name;
        if (is_dielectric(kind)) {
            EXPECT_GT(transmitted, sample_count / 20) << kind.name;
        }
    }
}

TEST(BsdfModes, SamplesOfBothAreTheSameButForTheSquaredIndex) {
    // So each test of directions against densities is one of both modes.
    std::mt19937_64 random(23);
    for (const Kind &kind : kinds) {
        int found = 0, other = 0;
        for (int i = 0; i < sample_count / 4; ++i) {
            const lib::material m = draw_material(random);
            const lib::vec3 wi = draw_direction(random);
            const real u_lobe = draw(random), u1 = draw(random), u2 = draw(random);
            const lib::bsdf_sample a = kind.sample(m, wi, u_lobe, u1, u2, lib::transport_radiance),
                                   b = kind.sample(m, wi, u_lobe, u1, u2, lib::transport_importance);
            ASSERT_EQ(a.wo.x, b.wo.x);
            ASSERT_EQ(a.wo.y, b.wo.y);
            ASSERT_EQ(a.wo.z, b.wo.z);
            ASSERT_EQ(a.pdf, b.pdf);
            ASSERT_EQ(a.pdf_reverse, b.pdf_reverse);
            ASSERT_EQ(a.eta, b.eta);
            ASSERT_EQ(a.is_specular, b.is_specular);
            found += a.pdf > 0;
            if (std::string(kind.name) == "principledthin" && a.wo.z * wi.z < 0)
                continue; // what it lets pass is not the same both ways
            const double squared = double(a.eta) * a.eta;
            ASSERT_NEAR(b.weight.r, a.weight.r * squared, bound(2e-6, 1e-14)) << kind.name;
            ASSERT_NEAR(b.weight.g, a.weight.g * squared, bound(2e-6, 1e-14)) << kind.name;
            ASSERT_NEAR(b.weight.b, a.weight.b * squared, bound(2e-6, 1e-14)) << kind.name;
            other += a.pdf > 0 && squared != 1;
        }
        EXPECT_GT(found, sample_count / 16) << kind.name;
        if (is_dielectric(kind)) {
            EXPECT_GT(other, sample_count / 16) << kind.name;
        }
    }
}

TEST(BsdfModes, NoSampleOfImportanceGainsPower) {
    // Power is scattered, not made: of white materials each sample weighs at most 1, from either side.
    std::mt19937_64 random(24);
    for (const Kind &kind : kinds)
        for (int i = 0; i < sample_count / 4; ++i) {
            const double alpha = std::pow(10.0, -4 * double(draw(random)));
            const lib::material m = white_material_of(kind, alpha, 0.7 * alpha, i % 2 ? 1.5 : 0.7);
            const lib::vec3 wi = draw_direction(random);
            const real u_lobe = draw(random), u1 = draw(random), u2 = draw(random);
            const lib::bsdf_sample sample = kind.sample(m, wi, u_lobe, u1, u2, lib::transport_importance);
            // Of many lobes each weighs at most 1 over the chance to sample it, which is that of a coat at normal
            // incidence or more.
            ASSERT_LE(sample.weight.g, has_many_lobes(kind) ? std::pow(1.7 / 0.3, 2) : 1 + bound(1e-6, 1e-14))
                << kind.name;
        }
}

TEST(BsdfModes, SampledDensitiesAndValuesAreThoseOfThePair) {
    std::mt19937_64 random(25);
    for (const Kind &kind : kinds) {
        if (kind.is_delta)
            continue;
        for (int i = 0; i < sample_count / 4; ++i) {
            const lib::material m = draw_material(random);
            const lib::vec3 wi = draw_direction(random);
            const real u_lobe = draw(random), u1 = draw(random), u2 = draw(random);
            for (const int mode : modes) {
                const lib::bsdf_sample sample = kind.sample(m, wi, u_lobe, u1, u2, mode);
                if (sample.pdf == 0) {
                    ASSERT_EQ(sample.pdf_reverse, 0) << kind.name;
                    continue;
                }
                if (sample.is_specular)
                    continue;
                // The two copies may be contracted differently, see BsdfIdentities.
                const lib::bsdf_value pair = kind.evaluate(m, wi, sample.wo, mode);
                if (sample.pdf_reverse == 0) {
                    ASSERT_EQ(pair.pdf_reverse, 0) << kind.name;
                    continue;
                }
                ASSERT_NEAR(pair.pdf_reverse / sample.pdf_reverse, 1, bound(1e-5, 1e-12)) << kind.name;
                ASSERT_NEAR(pair.value.g / sample.pdf, sample.weight.g, bound(1e-5, 1e-12) * (1 + sample.weight.g));
            }
        }
    }
}

TEST(BsdfModes, DiracLobesHaveTheirProbabilityAndThatOfTheWayBack) {
    for (const Kind &kind : kinds) {
        if (!kind.is_delta)
            continue;
        std::mt19937_64 random(26);
        for (int i = 0; i < sample_count / 20; ++i) {
            const lib::material m = draw_material(random);
            lib::vec3 wi = draw_direction(random);
            if (!is_dielectric(kind) && std::string(kind.name) != "null")
                wi.z = std::fabs(wi.z);
            const lib::bsdf_sample there = kind.sample(m, wi, draw(random), 0, 0);
            ASSERT_TRUE(there.is_specular) << kind.name;
            ASSERT_GT(there.pdf, 0) << kind.name;
            ASSERT_LE(there.pdf, 1) << kind.name;
            ASSERT_EQ(kind.pdf(m, wi, there.wo), 0) << kind.name;
            ASSERT_EQ(kind.evaluate(m, wi, there.wo).pdf_reverse, 0) << kind.name;
            if (std::fabs(there.wo.z) < R(0.02) || std::fabs(wi.z) < R(0.02))
                continue; // near total reflection Fresnel's curve is too steep for rounded directions
            // Below and above all reflectances: the same lobe again, backwards.
            const bool is_reflected = there.wo.z * wi.z > 0;
            const lib::bsdf_sample back = kind.sample(m, there.wo, is_reflected ? R(-1) : R(2), 0, 0);
            ASSERT_NEAR(lib::v3_dot(back.wo, wi), 1, bound(1e-5, 1e-12)) << kind.name;
            ASSERT_NEAR(there.pdf_reverse, back.pdf, bound(1e-4, 1e-11)) << kind.name;
        }
    }
}

TEST(BsdfModes, OtherLobesAreNotSpecular) {
    std::mt19937_64 random(27);
    for (const Kind &kind : kinds) {
        if (kind.is_delta)
            continue;
        int smooth = 0;
        for (int i = 0; i < 1000; ++i) {
            const lib::bsdf_sample sample =
                kind.sample(draw_material(random), draw_direction(random), draw(random), draw(random), draw(random));
            smooth += !sample.is_specular && sample.pdf > 0;
        }
        EXPECT_GT(smooth, 200) << kind.name;
    }
}
