// Identities that hold for each pair of directions: weight pdf = eval, pdf of the sample = K_pdf, reciprocity.
#include "tests/kernels/bsdf_case.h"

#include <gtest/gtest.h>
#include <random>

using namespace gradus::testing;

namespace {

double index_ratio(const lib::material &m, lib::vec3 wi) { return wi.z > 0 ? m.ior : 1 / double(m.ior); }

} // namespace

TEST(BsdfIdentities, SampleWeightIsEvalOverPdf) {
    std::mt19937_64 random(11);
    for (const Kind &kind : kinds) {
        if (kind.is_delta)
            continue;
        int found = 0;
        for (int i = 0; i < sample_count / 4; ++i) {
            const double alpha = std::pow(10.0, -4 * double(draw(random)));
            const lib::material m = coloured_material(alpha, alpha * 0.7, i % 2 ? 1.5 : 0.6);
            const lib::vec3 wi = draw_direction(random);
            const real u_lobe = draw(random), u1 = draw(random), u2 = draw(random);
            const lib::bsdf_sample sample = kind.sample(m, wi, u_lobe, u1, u2);
            if (sample.pdf == 0) {
                ASSERT_EQ(lib::rgb_max(sample.weight), 0);
                continue;
            }
            ++found;
            if (sample.is_specular)
                continue; // of a Dirac lobe beside rough ones, which evaluation leaves out
            const lib::rgb value = kind.eval(m, wi, sample.wo);
            // Not equal bit by bit: the compiler may contract the two copies differently. D of a smooth surface
            // turns such a last bit into much more, but eval and pdf share it, so compare their ratio too.
            ASSERT_NEAR(kind.pdf(m, wi, sample.wo) / sample.pdf, 1, bound(1e-5, 1e-12)) << kind.name;
            ASSERT_NEAR(value.r / sample.pdf, sample.weight.r, bound(1e-5, 1e-12) * (1 + sample.weight.r));
            ASSERT_NEAR(value.g / sample.pdf, sample.weight.g, bound(1e-5, 1e-12) * (1 + sample.weight.g));
            ASSERT_NEAR(value.b / sample.pdf, sample.weight.b, bound(1e-5, 1e-12) * (1 + sample.weight.b));
            ASSERT_NEAR(lib::v3_length_squared(sample.wo), 1, bound(2e-6, 1e-13)) << kind.name;
            const bool is_transmitted = sample.wo.z * wi.z < 0;
            ASSERT_NEAR(sample.eta, is_transmitted && is_dielectric(kind) ? index_ratio(m, wi) : 1, 1e-6);
        }
        EXPECT_GT(found, sample_count / 16) << kind.name;
    }
}

TEST(BsdfIdentities, ReflectionIsReciprocal) {
    std::mt19937_64 random(12);
    for (const Kind &kind : kinds) {
        if (kind.is_delta)
            continue;
        int found = 0;
        for (int i = 0; i < sample_count / 4; ++i) {
            const double alpha = 0.05 + 0.95 * double(draw(random));
            const lib::material m = coloured_material(alpha, 0.5 * alpha + 0.05, 1.5);
            lib::vec3 wi = draw_direction(random), wo = draw_direction(random);
            const real side = is_dielectric(kind) && i % 2 ? R(-1) : R(1);
            wi.z = side * std::max(std::fabs(wi.z), R(1e-3)), wo.z = side * std::max(std::fabs(wo.z), R(1e-3));
            wi = lib::v3_normalize(wi), wo = lib::v3_normalize(wo);
            const double there = kind.eval(m, wi, wo).g / std::fabs(double(wo.z));
            const double back = kind.eval(m, wo, wi).g / std::fabs(double(wi.z));
            found += there > 1e-6;
            ASSERT_NEAR(there, back, bound(2e-4, 1e-11) * std::max(there, back) + bound(1e-9, 1e-20))
                << kind.name << " " << i;
        }
        EXPECT_GT(found, sample_count / 16) << kind.name;
    }
}

TEST(BsdfIdentities, TransmissionIsReciprocalUpToTheSquaredIndex) {
    // f(wo -> wi) = eta^2 f(wi -> wo), eta the index on wo's side over that on wi's: radiance over index squared.
    std::mt19937_64 random(13);
    for (const Kind &kind : kinds) {
        if (kind.is_delta || !is_dielectric(kind))
            continue;
        int found = 0;
        for (int i = 0; i < sample_count / 4; ++i) {
            const double alpha = 0.1 + 0.9 * double(draw(random));
            const lib::material m = coloured_material(alpha, 0.5 * alpha + 0.05, i % 2 ? 1.5 : 0.7);
            const lib::vec3 wi = draw_direction(random);
            lib::vec3 wo = draw_direction(random);
            wo.z = wi.z > 0 ? -std::fabs(wo.z) : std::fabs(wo.z);
            if (std::min(std::fabs(wi.z), std::fabs(wo.z)) < R(1e-3))
                continue;
            const double eta = index_ratio(m, wi);
            const double there = kind.eval(m, wi, wo).g / std::fabs(double(wo.z)) * eta * eta;
            const double back = kind.eval(m, wo, wi).g / std::fabs(double(wi.z));
            found += there > 1e-6;
            // In float both lobes end where wi.m = 0, and the two sides round that end differently.
            ASSERT_NEAR(there, back, bound(1e-3, 1e-9) * std::max(there, back) + bound(3e-5, 1e-13))
                << kind.name << " " << i;
        }
        EXPECT_GT(found, sample_count / 100) << kind.name;
    }
}

TEST(BsdfIdentities, OneSidedKindsAreBlackFromBehind) {
    const lib::material m = coloured_material(0.3, 0.3);
    for (const Kind &kind : kinds) {
        if (transmits(kind))
            continue;
        EXPECT_EQ(kind.sample(m, direction(120, 0), R(0.5), R(0.5), R(0.5)).pdf, 0) << kind.name;
        EXPECT_EQ(lib::rgb_max(kind.eval(m, direction(120, 0), direction(30, 0))), 0) << kind.name;
        EXPECT_EQ(lib::rgb_max(kind.eval(m, direction(30, 0), direction(120, 0))), 0) << kind.name;
        EXPECT_EQ(kind.pdf(m, direction(30, 0), direction(120, 0)), 0) << kind.name;
    }
}

TEST(BsdfIdentities, EachChannelReadsItsOwnFields) {
    // A permutation of the material's channels permutes the result.
    lib::material m = coloured_material(0.3, 0.3);
    m.spec_tint = m.sheen_tint = 0; // tints go by luminance, which the permutation changes
    lib::material p = m;
    p.reflectance_r = m.reflectance_g, p.reflectance_g = m.reflectance_b, p.reflectance_b = m.reflectance_r;
    p.specular_reflectance_r = m.specular_reflectance_g, p.specular_reflectance_g = m.specular_reflectance_b;
    p.specular_reflectance_b = m.specular_reflectance_r;
    p.specular_transmittance_r = m.specular_transmittance_g, p.specular_transmittance_g = m.specular_transmittance_b;
    p.specular_transmittance_b = m.specular_transmittance_r;
    p.eta_r = m.eta_g, p.eta_g = m.eta_b, p.eta_b = m.eta_r;
    p.k_r = m.k_g, p.k_g = m.k_b, p.k_b = m.k_r;
    for (const Kind &kind : kinds)
        for (const real u_lobe : {R(0), R(0.9)}) {
            const lib::rgb a = kind.sample(m, direction(20, 0), u_lobe, R(0.3), R(0.6)).weight;
            const lib::rgb b = kind.sample(p, direction(20, 0), u_lobe, R(0.3), R(0.6)).weight;
            EXPECT_NEAR(b.r, a.g, 1e-6) << kind.name;
            EXPECT_NEAR(b.g, a.b, 1e-6) << kind.name;
            EXPECT_NEAR(b.b, a.r, 1e-6) << kind.name;
            const lib::rgb albedo = kind.albedo(m), permuted = kind.albedo(p);
            EXPECT_NEAR(permuted.r, albedo.g, 1e-6) << kind.name;
            EXPECT_NEAR(permuted.b, albedo.r, 1e-6) << kind.name;
        }
}

// Each Dirac kind through `specular` is itself, but for how the compiler contracts two copies of it; a kind that is
// none has no sample there.
TEST(BsdfIdentities, SpecularIsEachDiracKind) {
    std::mt19937_64 random(15);
    for (std::size_t number = 0; number < kinds.size(); ++number) {
        const Kind &kind = kinds[number];
        for (int i = 0; i < sample_count / 16; ++i) {
            lib::material m = coloured_material(0.1, 0.1, i % 2 ? 1.5 : 0.6);
            m.bsdf = real(number);
            const lib::vec3 wi = draw_direction(random);
            const real u_lobe = draw(random), u1 = draw(random), u2 = draw(random);
            const int mode = i % 3 ? lib::transport_radiance : lib::transport_importance;
            const lib::bsdf_sample through = lib::specular_sample(m, wi, u_lobe, u1, u2, mode);
            ASSERT_TRUE(through.is_specular);
            if (!kind.is_delta) {
                ASSERT_EQ(through.pdf, 0);
                ASSERT_EQ(lib::rgb_max(through.weight), 0);
                continue;
            }
            const lib::bsdf_sample sample = kind.sample(m, wi, u_lobe, u1, u2, mode);
            const lib::rgb albedo = kind.albedo(m), albedo_through = lib::specular_albedo(m);
            const auto same = [](real a, real b) { return std::fabs(a - b) <= bound(1e-6, 1e-14) * std::fabs(a); };
            ASSERT_TRUE(same(sample.wo.x, through.wo.x) && same(sample.wo.y, through.wo.y) &&
                        same(sample.wo.z, through.wo.z))
                << kind.name;
            ASSERT_TRUE(same(sample.weight.r, through.weight.r) && same(sample.weight.g, through.weight.g) &&
                        same(sample.weight.b, through.weight.b))
                << kind.name;
            ASSERT_TRUE(same(sample.pdf, through.pdf) && same(sample.pdf_reverse, through.pdf_reverse)) << kind.name;
            ASSERT_EQ(sample.eta, through.eta) << kind.name;
            ASSERT_TRUE(same(albedo.r, albedo_through.r) && same(albedo.g, albedo_through.g) &&
                        same(albedo.b, albedo_through.b))
                << kind.name;
        }
    }
}
