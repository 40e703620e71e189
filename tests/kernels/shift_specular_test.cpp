// The shift at Dirac vertices against what the smooth dielectric samples.
#include "tests/kernels/bsdf_case.h"
#include "tests/kernels/lib_vector.h"
#include "tests/kernels/shift_case.h"

#include "kernels/lib/shift_specular.h"

using namespace gradus::testing;

TEST(ShiftSpecular, IsWhatTheDielectricSamples) {
    ShiftCases cases(1, 0.01);
    int refractions = 0, failures = 0;
    for (int i = 0; i < sample_count / 4; ++i) {
        const double ior_base = 0.4 + 2.1 * cases.uniform(), ior_offset = 0.4 + 2.1 * cases.uniform();
        const lib::vec3 wi = as_real(cases.draw_direction()), wi_offset = as_real(cases.draw_direction());
        const lib::material glass = white_material(0, 0, ior_base), other = white_material(0, 0, ior_offset);
        const bool is_reflection = i % 4 == 0;
        // u_lobe 0 reflects, 1 refracts where anything is transmitted
        const lib::bsdf_sample base =
            lib::dielectric_sample(glass, wi, is_reflection ? 0 : 1, 0, 0, lib::transport_radiance);
        const lib::bsdf_sample offset =
            lib::dielectric_sample(other, wi_offset, is_reflection ? 0 : 1, 0, 0, lib::transport_radiance);
        if (!(base.pdf > 0))
            continue; // the base is totally reflected
        const lib::shifted_direction result = lib::shift_specular(wi, base.wo, wi_offset, real(ior_offset));
        const bool is_expected = wi.z * wi_offset.z > 0 && offset.pdf > 0;
        if (offset.pdf < 1e-3 && !is_reflection)
            continue; // near total reflection the sampler may say 0 first
        ASSERT_EQ(result.is_valid, is_expected);
        failures += !result.is_valid;
        if (!result.is_valid) {
            ASSERT_EQ(result.jacobian, 0);
            continue;
        }
        refractions += !is_reflection;
        ASSERT_EQ(result.jacobian, 1);
        ASSERT_LT(distance(result.wo, offset.wo), 2 * epsilon); // the compiler may contract the two differently
        const lib::shifted_direction back = lib::shift_specular(wi_offset, result.wo, wi, real(ior_base));
        ASSERT_TRUE(back.is_valid);
        ASSERT_LT(distance(back.wo, base.wo), 2 * epsilon);
    }
    EXPECT_GT(refractions, sample_count / 40);
    EXPECT_GT(failures, sample_count / 40);
}

TEST(ShiftSpecular, IsTheHalfVectorCopyOfTheSurfaceNormal) {
    ShiftCases cases(2, 0.01);
    int found = 0;
    for (int i = 0; i < sample_count / 10; ++i) {
        LongVector wi = cases.draw_direction(), wi_offset = cases.draw_direction();
        if (std::min(std::fabs(wi.z), std::fabs(wi_offset.z)) < 0.1L)
            continue;
        const long double ior = i % 2 ? 1.5L : 0.7L;
        const long double side = wi.z > 0 ? 1 : -1;
        const auto refraction = refracted(wi, {0, 0, side}, eta_of(wi, false, ior));
        const LongVector wo = i % 3 && refraction ? *refraction : reflected(wi, {0, 0, side});
        if (std::fabs(wo.z) < 0.1L)
            continue;
        const auto smooth = lib::shift_specular(as_real(wi), as_real(wo), as_real(wi_offset), real(ior));
        const auto rough = lib::shift_half_vector(as_real(wi), as_real(wo), real(ior), as_real(wi_offset), real(ior));
        if (smooth.is_valid && std::fabs(smooth.wo.z) < 0.1)
            continue;
        ASSERT_EQ(smooth.is_valid, rough.is_valid);
        found += smooth.is_valid;
        // the normal is known to epsilon / |h|, |h| > 0.3, and root to that over 0.1
        if (smooth.is_valid) {
            ASSERT_LT(distance(smooth.wo, rough.wo), 64 * epsilon);
        }
    }
    EXPECT_GT(found, sample_count / 100);
}

TEST(ShiftSpecular, EdgesAndEqualIndices) {
    const lib::vec3 above = direction(40, 10), down = lib::v3(real(0.1), 0, real(-0.9)), up = lib::v3(0, 0, 1);
    // An index ratio of 1 lets the ray pass straight through, at every angle.
    for (const double angle : {0.0, 30.0, 89.0, 91.0, 179.0}) {
        const lib::vec3 wi = direction(angle, 70);
        const auto through = lib::shift_specular(wi, lib::v3_neg(wi), wi, 1);
        ASSERT_TRUE(through.is_valid) << angle;
        EXPECT_LT(distance(through.wo, lib::v3_neg(wi)), 2 * epsilon / 0.01);
        EXPECT_EQ(through.jacobian, 1);
    }
    // Critical angle from inside 1.5: 41.81 degrees.
    EXPECT_TRUE(lib::shift_specular(lib::v3_neg(up), up, direction(180 - 41.5, 0), R(1.5)).is_valid);
    EXPECT_FALSE(lib::shift_specular(lib::v3_neg(up), up, direction(180 - 42.1, 0), R(1.5)).is_valid);
    // A total reflection can be shifted to a partial one, and back.
    EXPECT_TRUE(lib::shift_specular(direction(120, 0), direction(120, 180), direction(170, 0), R(1.5)).is_valid);
    EXPECT_TRUE(lib::shift_specular(direction(170, 0), direction(170, 180), direction(120, 0), R(1.5)).is_valid);
    const lib::vec3 along = lib::v3(1, 0, 0);
    EXPECT_FALSE(lib::shift_specular(along, down, above, R(1.5)).is_valid);
    EXPECT_FALSE(lib::shift_specular(above, along, above, R(1.5)).is_valid);
    EXPECT_FALSE(lib::shift_specular(above, down, along, R(1.5)).is_valid);
    EXPECT_FALSE(lib::shift_specular(above, up, along, R(1.5)).is_valid);
    for (const double ior : {0.0, -1.0, 1e30}) {
        const auto bad = lib::shift_specular(above, down, above, real(ior));
        EXPECT_FALSE(bad.is_valid);
        EXPECT_EQ(bad.wo.z, 0);
    }
}
