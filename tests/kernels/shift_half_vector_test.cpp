// Half-vector copies against the copy in long double, and their Jacobians against its differences.
#include "tests/kernels/lib_vector.h"
#include "tests/kernels/shift_case.h"
#include "tests/support/stability.h"
#include "tests/support/worse.h"

#include "kernels/lib/shift_half_vector.h"

#include <cstdio>
#include <vector>

using namespace gradus::testing;

namespace {

lib::shifted_direction shifted(const ShiftCase &c) {
    return lib::shift_half_vector(as_real(c.wi_base), as_real(c.wo_base), real(c.ior_base), as_real(c.wi_offset),
                                  real(c.ior_offset));
}

/// The case whose directions `real` holds; wo_base stays at unit length and on its microfacet to rounding only.
ShiftCase rounded(ShiftCase c) {
    for (LongVector *v : {&c.wi_base, &c.wo_base, &c.wi_offset})
        *v = as_long(as_real(*v));
    c.ior_base = real(c.ior_base), c.ior_offset = real(c.ior_offset);
    return c;
}

/// The shift back, from the result of the shift.
lib::shifted_direction shifted_back(const ShiftCase &c, const lib::shifted_direction &there) {
    return lib::shift_half_vector(as_real(c.wi_offset), there.wo, real(c.ior_offset), as_real(c.wi_base),
                                  real(c.ior_base));
}

/// What rounding of the arguments does to the result: the normal is known to epsilon / |h|, cosines to that, a cosine
/// from total reflection to that over itself, and Jacobians have one cosine in the denominator.
double condition(const ShiftCase &c) {
    const double cosine = c.microfacet_cosine();
    return 1 / (c.half_vector_length() * cosine * cosine);
}

constexpr const char *area = "Half-vector copy";
constexpr const char *of_rounding = "largest error of the Jacobian over what rounding of the arguments allows";

NumericalJacobian numerical(const ShiftCase &c) {
    const long double cosine = c.microfacet_cosine(), half_vector = std::min(1.0, c.half_vector_length());
    // A move of wo turns the normal by some 1 / |h| of it: small against the cosine, for refraction against its square.
    const long double step = 0.02L * half_vector * cosine * (c.is_reflection ? 1 : cosine);
    return solid_angle_jacobian([&](LongVector move) { return c.copy(normalized(c.wo_base + move)); }, c.wo_base, step);
}

/// The Jacobian's error over what rounding of the arguments allows; the differences know it to 1e-8.
double jacobian_error_over_allowed(const ShiftCase &c, const lib::shifted_direction &result) {
    const double error = std::fabs(result.jacobian / double(numerical(c).value) - 1);
    return error / (8 * epsilon * condition(c) + 1e-8);
}

/// Cases that draw() makes. It may fail, and then gives none.
template <class Draw>
std::vector<ShiftCase> draw_200(Draw draw) {
    std::vector<ShiftCase> cases;
    for (int tries = 0; cases.size() < 200 && tries < 1'000'000; ++tries)
        if (const std::optional<ShiftCase> drawn = draw())
            cases.push_back(*drawn);
    EXPECT_EQ(cases.size(), 200u) << "draws fail too often";
    return cases;
}

struct JacobianFactors {
    double eta, cosine, half_vector; ///< offset over base: index ratio, |wo.m|, |h|
};

JacobianFactors factors(const ShiftCase &c) {
    const LongVector m = c.normal();
    return {
        double(c.offset_eta() / c.base_eta()), double(std::fabs(dot(c.wo_offset(), m) / dot(c.wo_base, m))),
        double(length(c.wi_offset + c.offset_eta() * c.wo_offset()) / length(c.wi_base + c.base_eta() * c.wo_base))};
}

} // namespace

TEST(ShiftHalfVector, DirectionAndJacobianAreThoseOfTheCopy) {
    ShiftCases cases(1, 0.0101);
    double largest = 0, largest_direction = 0, largest_uncertainty = 0, worst_grazing = 0, worst_near_total = 0;
    int near_total = 0, grazing = 0, reflections = 0, different = 0;
    for (int i = 0; i < sample_count / 20; ++i) {
        const ShiftCase c = cases.draw();
        const NumericalJacobian truth = numerical(c);
        ASSERT_LT(truth.relative_error, 1e-8L) << c.microfacet_cosine() << " " << c.half_vector_length();
        const lib::shifted_direction result = shifted(c);
        ASSERT_TRUE(result.is_valid || c.microfacet_cosine() < 0.01 + 64 * epsilon / 0.01);
        if (!result.is_valid)
            continue;
        const double error = std::fabs(result.jacobian / double(truth.value) - 1);
        const double direction_error = distance(as_long(result.wo), c.wo_offset());
        const double allowed = 8 * epsilon * condition(c);
        ASSERT_LT(error, allowed + 1e-8) << c.is_reflection << " " << c.microfacet_cosine() << " " << c.base_eta()
                                         << " " << c.offset_eta();
        ASSERT_LT(direction_error, allowed);
        largest = worse(largest, error);
        largest_direction = worse(largest_direction, direction_error);
        largest_uncertainty = worse(largest_uncertainty, double(truth.relative_error));
        const LongVector m = c.normal();
        const bool is_near_total = !c.is_reflection && std::fabs(dot(c.wo_offset(), m)) < 0.03L && c.offset_eta() < 1;
        const bool is_grazing = std::fabs(dot(c.wi_offset, m)) < 0.03L;
        near_total += is_near_total;
        grazing += is_grazing;
        worst_near_total = worse(worst_near_total, is_near_total ? error / (allowed + 1e-8) : 0);
        if (is_grazing && c.is_reflection) {
            const double base_half_vector = double(length(c.wi_base + c.wo_base));
            worst_grazing =
                std::max(worst_grazing, error / (16 * epsilon / (base_half_vector * c.microfacet_cosine()) + 1e-8));
        }
        reflections += c.is_reflection;
        different += !c.is_reflection && c.ior_base != c.ior_offset;
    }
    std::printf("  largest error: Jacobian %.1e, direction %.1e; the differences know it to %.1e\n"
                "  %d reflections, %d refractions of unlike indices, %d near total reflection, %d grazing\n",
                largest, largest_direction, largest_uncertainty, reflections, different, near_total, grazing);
    EXPECT_LT(largest, bound(0.1, 1e-6));
    for (const int count : {near_total, grazing, reflections, different})
        EXPECT_GT(count, sample_count / 2000);
    record_stability(
        {area, "grazing incidence: the Jacobian has a cosine against the microfacet in its denominator",
         "reflections whose offset has a cosine of 0.01 to 0.03 against the microfacet",
         "right as far as rounding allows; below 0.001 (reflection) and 0.01 (refraction) the shift fails, "
         "and so does the shift back",
         of_rounding, worst_grazing, 1});
    record_stability({area, "near total internal reflection the transmitted direction turns without bound",
                      "refractions that leave at a cosine of 0.01 to 0.03 against the microfacet",
                      "right as far as rounding allows", of_rounding, worst_near_total, 1});
}

// Near 1 the half vector is short. Its normal is known to epsilon / |h|, the copied direction to epsilon.
TEST(ShiftHalfVector, IndexRatiosNearOne) {
    ShiftCases cases(2, 0.3);
    double worst = 0;
    for (const double contrast : {1e-4, 1e-3, 1e-2, -1e-2, -1e-3, -1e-4})
        for (const ShiftCase &c : draw_200([&] { return cases.draw_refraction_of_index(real(1 + contrast)); })) {
            const lib::shifted_direction result = shifted(c);
            ASSERT_TRUE(result.is_valid) << contrast;
            ASSERT_LT(distance(as_long(result.wo), c.wo_offset()), 32 * epsilon);
            worst = worse(worst, jacobian_error_over_allowed(c, result));
        }
    record_stability({area, "index ratios near 1: the half vector vanishes and its normal is rounding",
                      "index ratios that differ from 1 by 1e-4 to 1e-2, to both sides",
                      "no cancellation in the Jacobian; nearer than 5e-5 the shift fails", of_rounding, worst, 1});
}

// The microfacet nearly stands on the surface: its normal's side is what is left of the directions' sum.
TEST(ShiftHalfVector, NormalsNearTheSurface) {
    ShiftCases cases(6, 0.0101);
    double worst = 0;
    for (const double height : {1e-2, 1e-3, 1e-4, 1e-5})
        for (const ShiftCase &c : draw_200([&] { return cases.draw_refraction_at_height(height); })) {
            const lib::shifted_direction result = shifted(c);
            // Within rounding of the surface the normal may be taken for one on the other side.
            if (!result.is_valid && height < 16 * epsilon / c.half_vector_length())
                continue;
            ASSERT_TRUE(result.is_valid) << height;
            ASSERT_LT(distance(as_long(result.wo), c.wo_offset()), 8 * epsilon * condition(c));
            worst = worse(worst, jacobian_error_over_allowed(c, result));
        }
    record_stability({area, "a transmitted half vector near the surface: rounding decides on which side it is",
                      "refractions with normals at 1e-5 to 1e-2 above the surface",
                      "right as far as rounding allows, or the shift fails for both directions alike", of_rounding,
                      worst, 1});
}

// What the copy is for: the offset path's microfacet is as likely as the base path's, however narrow the distribution.
// Errors of the half vector, epsilon / |h|, count relative to the roughness.
TEST(ShiftHalfVector, MicrofacetsStayAsLikelyAtAnyRoughness) {
    ShiftCases cases(7, 0.1);
    double worst = 0;
    for (const double alpha : {1e-4, 1e-3, 1e-2, 0.1, 1.0})
        for (int i = 0; i < sample_count / 20; ++i) {
            const auto c = cases.draw_at_roughness(alpha);
            if (!c)
                continue;
            const lib::shifted_direction result = shifted(*c);
            if (!result.is_valid)
                continue;
            const auto density = [&](lib::vec3 wi, lib::vec3 wo, double eta) {
                lib::vec3 h = lib::v3_mad(wi, real(eta), wo);
                if (h.z < 0)
                    h = lib::v3_neg(h);
                return double(lib::microfacet_density(lib::microfacet_ggx, h, lib::v3_length_squared(h), real(alpha),
                                                      real(alpha)));
            };
            const double base = density(as_real(c->wi_base), as_real(c->wo_base), double(c->base_eta()));
            const double offset = density(as_real(c->wi_offset), result.wo, double(c->offset_eta()));
            // d log D / d slope is at most 2 / alpha, the base's normal is rounded and the offset's again.
            const double allowed = 8 * epsilon * condition(*c) * (1 + 1 / alpha);
            ASSERT_TRUE(std::isfinite(base) && std::isfinite(offset));
            worst = worse(worst, std::fabs(std::log(offset / base)) / allowed);
        }
    record_stability({area, "roughness near 0: a microfacet that is off by rounding is no longer likely",
                      "GGX of roughness 1e-4 to 1, microfacets as it samples them, cosines over 0.1",
                      "the copy keeps the microfacet to the rounding of its half vector",
                      "largest change of log D over what rounding allows", worst, 1});
}

TEST(ShiftHalfVector, IsUndoneByTheShiftBack) {
    ShiftCases cases(3, 0.0101, 1e-3);
    double largest = 0, largest_direction = 0, largest_plain = 0;
    for (int i = 0; i < sample_count / 4; ++i) {
        const ShiftCase c = rounded(cases.draw());
        const lib::shifted_direction there = shifted(c);
        // Within rounding of the bound that the cases keep to.
        if (!there.is_valid && c.microfacet_cosine() < 0.01 + 64 * epsilon / 0.01)
            continue;
        ASSERT_TRUE(there.is_valid);
        const lib::shifted_direction back = shifted_back(c, there);
        if (!back.is_valid && c.microfacet_cosine() < 0.01 + 64 * epsilon / 0.01)
            continue;
        ASSERT_TRUE(back.is_valid) << c.microfacet_cosine();
        const double error = std::fabs(double(there.jacobian) * back.jacobian - 1);
        const double direction_error = distance(as_long(back.wo), c.wo_base);
        ASSERT_LT(error, 16 * epsilon * condition(c)) << c.is_reflection << " " << c.microfacet_cosine();
        ASSERT_LT(direction_error, 16 * epsilon * condition(c));
        largest = worse(largest, error);
        largest_direction = worse(largest_direction, direction_error);
        if (c.microfacet_cosine() > 0.1 && c.half_vector_length() > 0.2)
            largest_plain = std::max({largest_plain, error, direction_error});
    }
    std::printf("  largest error: product of Jacobians %.1e, direction %.1e; away from edges %.1e\n", largest,
                largest_direction, largest_plain);
    EXPECT_LT(largest_plain, bound(1e-4, 1e-12));
}

// Any arguments, so that every reason to fail occurs: where the shift succeeds the shift back must, and find the base.
TEST(ShiftHalfVector, FailureIsSymmetric) {
    ShiftCases cases(4, 0.01);
    int succeeded = 0, at_a_bound = 0, count = 0;
    const double iors[] = {0.4, 0.7, 0.9999, 0.99997, 1, 1.00003, 1.0001, 1.33, 1.5, 2.5};
    for (int i = 0; i < sample_count; ++i, ++count) {
        const auto ior = [&] { return iors[std::min(int(cases.uniform() * 10), 9)]; };
        ShiftCase c{false, cases.draw_direction(), cases.draw_direction(), cases.draw_direction(), ior(), ior()};
        if (i % 2) // or a base that exists
            if (const auto wo = refracted(c.wi_base, normalized(LongVector{0, 0, 1} + 0.3L * cases.draw_direction()),
                                          eta_of(c.wi_base, false, c.ior_base)))
                c.wo_base = *wo;
        c.is_reflection = c.wi_base.z * c.wo_base.z > 0;
        c = rounded(c);
        const lib::shifted_direction there = shifted(c);
        if (!there.is_valid) {
            ASSERT_EQ(there.jacobian, 0);
            ASSERT_EQ(lib::v3_length_squared(there.wo), 0);
            continue;
        }
        ++succeeded;
        ASSERT_TRUE(there.jacobian > 0 && std::isfinite(there.jacobian));
        ASSERT_GT(c.wi_base.z * c.wi_offset.z, 0);
        ASSERT_EQ(there.wo.z * c.wi_offset.z > 0, c.is_reflection);
        const lib::shifted_direction back = shifted_back(c, there);
        if (!back.is_valid) {
            // Allowed within rounding of a bound: the cosines' against the microfacet, or the surface's horizon.
            const double slack = 16 * epsilon * condition(c);
            const LongVector wo = as_long(there.wo), m = c.normal();
            const double least = c.is_reflection ? 1e-3 : 1e-2;
            const double horizon = double(std::min({std::fabs(wo.z), std::fabs(c.wo_base.z), std::fabs(m.z)}));
            ASSERT_TRUE(std::fabs(c.microfacet_cosine() - least) < slack || horizon < slack)
                << c.microfacet_cosine() << " " << horizon << " " << slack;
            ++at_a_bound;
        } else {
            ASSERT_LT(distance(as_long(back.wo), c.wo_base), 16 * epsilon * condition(c));
        }
    }
    std::printf("  %d of %d shifts succeed, %d of them within rounding of failure\n", succeeded, count, at_a_bound);
    EXPECT_GT(succeeded, count / 20);
    record_stability({area,
                      "total internal reflection on one side only, index ratios of 1, other sides, horizons: a shift "
                      "that succeeds where the shift back fails is biased",
                      "any directions, index ratios from 0.4 to 2.5",
                      "fails for both directions alike, but within rounding of a bound",
                      "share of successful shifts that the shift back does not undo", at_a_bound / double(succeeded),
                      bound(1e-3, 0)});
}

TEST(ShiftHalfVector, HandDerivedValues) {
    const double s = std::sqrt(0.5);
    const lib::vec3 wi = lib::v3(real(s), 0, real(s)), mirrored = lib::v3(real(-s), 0, real(s)), up = lib::v3(0, 0, 1);
    // The normal is z: mirror at a quarter of the circle, and straight back.
    lib::shifted_direction result = lib::shift_half_vector(wi, mirrored, 1, up, 1);
    ASSERT_TRUE(result.is_valid);
    EXPECT_NEAR(result.wo.z, 1, 4 * epsilon);
    EXPECT_NEAR(result.jacobian, 1 / s, 4 * epsilon);
    // From below into the thinner side, normal incidence on z, both materials alike: |h| = |1 - eta| for both.
    const lib::vec3 down = lib::v3(0, 0, -1);
    result = lib::shift_half_vector(down, up, R(1.5), down, R(1.5));
    ASSERT_TRUE(result.is_valid);
    EXPECT_NEAR(result.wo.z, 1, 4 * epsilon);
    EXPECT_NEAR(result.jacobian, 1, 16 * epsilon);
    // Unlike materials at normal incidence: a turn of m by e turns wo by (1 - 1 / eta) e.
    result = lib::shift_half_vector(up, down, R(1.5), up, R(2));
    ASSERT_TRUE(result.is_valid);
    EXPECT_NEAR(result.jacobian, std::pow((1 - 1 / 2.0) / (1 - 1 / 1.5), 2), 32 * epsilon);
}

TEST(ShiftHalfVector, EachFailure) {
    const auto unit = [](double x, double z) {
        const double length = std::hypot(x, z);
        return lib::v3(real(x / length), 0, real(z / length));
    };
    const lib::vec3 above = unit(0.3, 1), below = unit(-0.25, -1);
    const auto fails = [](lib::vec3 wi, lib::vec3 wo, double ior, lib::vec3 wi_offset, double ior_offset) {
        const lib::shifted_direction result = lib::shift_half_vector(wi, wo, real(ior), wi_offset, real(ior_offset));
        EXPECT_TRUE(result.is_valid || (result.jacobian == 0 && lib::v3_length_squared(result.wo) == 0));
        return !result.is_valid;
    };
    ASSERT_FALSE(fails(above, below, 1.5, unit(0.1, 1), 1.5));
    ASSERT_FALSE(fails(above, unit(0.1, 1), 1.5, unit(0.1, 1), 1.5));
    EXPECT_TRUE(fails(above, below, 1.5, unit(0.1, -1), 1.5)) << "other side";
    EXPECT_TRUE(fails(above, unit(0.1, 1), 1.5, unit(0.1, -1), 1.5)) << "other side";
    EXPECT_TRUE(fails(below, above, 1.5, unit(-2, -1), 1.5)) << "total reflection of the offset";
    EXPECT_TRUE(fails(above, below, 1.5, above, 0.1)) << "total reflection, other index";
    EXPECT_TRUE(fails(above, unit(0.9, 1), 1.5, unit(-1, 1), 1.5)) << "reflected below the horizon";
    EXPECT_TRUE(fails(above, unit(2, -1), 1.5, above, 1.5)) << "no microfacet refracts so";
    for (const double ior : {1.0, 1.00002, 0.99998, 0.0, -1.5, 1e-3, 1e5, 1e30}) {
        EXPECT_TRUE(fails(above, below, ior, above, 1.5)) << ior;
        EXPECT_TRUE(fails(above, below, 1.5, above, ior)) << ior;
        EXPECT_TRUE(fails(below, above, 1.5, below, ior)) << ior;
        EXPECT_FALSE(fails(above, unit(0.1, 1), ior, above, ior)) << "reflection does not read " << ior;
    }
    const lib::vec3 along = lib::v3(1, 0, 0), nothing = lib::v3(0, 0, 0);
    for (const lib::vec3 bad : {along, nothing}) {
        EXPECT_TRUE(fails(bad, below, 1.5, above, 1.5));
        EXPECT_TRUE(fails(above, bad, 1.5, above, 1.5));
        EXPECT_TRUE(fails(above, below, 1.5, bad, 1.5));
        EXPECT_TRUE(fails(above, unit(0.1, 1), 1.5, bad, 1.5));
    }
    EXPECT_TRUE(fails(unit(1, 4e-4), unit(-1, 4e-4), 1.5, above, 1.5)) << "grazes the microfacet";
    EXPECT_TRUE(fails(above, unit(-0.3, 1), 1.5, unit(1, 4e-4), 1.5)) << "grazes the microfacet";
    EXPECT_FALSE(fails(unit(1, 4e-3), unit(-1, 4e-3), 1.5, above, 1.5));
}

// The differences would see each of these.
TEST(ShiftHalfVector, DifferencesRefuteWrongFormulas) {
    ShiftCases cases(5, 0.05);
    int reflections = 0, refractions = 0, wrong_reflection = 0, no_reflection = 0;
    int no_index = 0, index_upside_down = 0, no_cosine = 0, cosine_of_wi = 0, no_half_vector = 0, no_square = 0;
    for (int i = 0; i < 4000; ++i) {
        const ShiftCase c = cases.draw();
        if (!c.is_reflection && c.ior_base == c.ior_offset)
            continue; // the index factor is 1
        const double truth = double(numerical(c).value);
        const JacobianFactors f = factors(c);
        const auto is_wrong = [&](double value) { return std::fabs(value / truth - 1) > 1e-2; };
        if (c.is_reflection) {
            ++reflections;
            EXPECT_NEAR(f.cosine / truth, 1, 1e-7);
            wrong_reflection += is_wrong(1 / f.cosine);
            no_reflection += is_wrong(1);
            continue;
        }
        ++refractions;
        const double square = f.half_vector * f.half_vector, indices = f.eta * f.eta;
        EXPECT_NEAR(square / (indices * f.cosine) / truth, 1, 1e-7);
        const LongVector m = c.normal();
        no_index += is_wrong(square / f.cosine);
        index_upside_down += is_wrong(square * indices / f.cosine);
        no_cosine += is_wrong(square / indices);
        cosine_of_wi += is_wrong(square / indices / double(dot(c.wi_offset, m) / dot(c.wi_base, m)));
        no_half_vector += is_wrong(1 / (indices * f.cosine));
        no_square += is_wrong(f.half_vector / (indices * f.cosine));
    }
    for (const int refuted : {wrong_reflection, no_reflection})
        EXPECT_GT(refuted, 0.95 * reflections);
    for (const int refuted : {no_index, index_upside_down, no_cosine, cosine_of_wi, no_half_vector, no_square})
        EXPECT_GT(refuted, 0.95 * refractions);
}
