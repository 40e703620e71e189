// Weights of multiple importance sampling: those of both strategies add up to one, whatever the densities.
#include "tests/kernels/precision.h"

#include <cmath>
#include <limits>
#include <random>
#include <tuple>

// The balance heuristic, and each strategy alone, beside one another.
#define STRATEGY 0
#include "kernels/lib/mis.h"
#undef GRADUS_LIB_MIS_H
#undef LIGHT_CAN_BE_FOUND
#undef STRATEGY
#define STRATEGY 1
#define mis_weight_light mis_weight_light_alone
#define weight_of_light_at_shared_vertex weight_of_light_at_shared_vertex_alone
#define mis_weight_bsdf mis_weight_bsdf_not_at_all
#include "kernels/lib/mis.h"
#undef GRADUS_LIB_MIS_H
#undef LIGHT_CAN_BE_FOUND
#undef STRATEGY
#undef mis_weight_light
#undef weight_of_light_at_shared_vertex
#undef mis_weight_bsdf
#define STRATEGY 2
#define mis_weight_light mis_weight_light_beside
#define weight_of_light_at_shared_vertex weight_of_light_at_shared_vertex_beside
#define mis_weight_bsdf mis_weight_bsdf_alone
#include "kernels/lib/mis.h"
#undef mis_weight_light
#undef weight_of_light_at_shared_vertex
#undef mis_weight_bsdf

using namespace gradus::testing;

namespace {

constexpr double epsilon_of_real = std::numeric_limits<real>::epsilon();

/// Densities of any magnitude that single precision holds.
real any_density(std::mt19937_64 &bits) {
    return real(std::pow(10, std::uniform_real_distribution<double>(-37, 38)(bits)));
}

} // namespace

// Veach (1997), eq. 9.8. Three roundings of half an epsilon each.
TEST(Mis, IsTheBalanceHeuristic) {
    std::mt19937_64 bits(1);
    for (int i = 0; i < 100'000; ++i) {
        const real light = any_density(bits);
        const real bsdf =
            i % 2 == 0 ? any_density(bits) : light * real(std::uniform_real_distribution<double>(0.1, 10)(bits));
        if (!std::isfinite(bsdf))
            continue;
        const double of_light = lib::mis_weight_light(light, bsdf), of_bsdf = lib::mis_weight_bsdf(bsdf, light);
        const long double sum = (long double)(light) + bsdf;
        const double share = double(light / sum), other = double(bsdf / sum);
        // Below the least normal number digits are lost.
        ASSERT_NEAR(of_light, share, 2 * epsilon_of_real * share + 1e-37) << light << ' ' << bsdf;
        ASSERT_NEAR(of_bsdf, other, 2 * epsilon_of_real * other + 1e-37) << light << ' ' << bsdf;
        ASSERT_NEAR(of_light + of_bsdf, 1, 2 * epsilon_of_real) << light << ' ' << bsdf;
    }
}

// What one strategy cannot find the other has whole: a Dirac light, a Dirac direction or the camera's own ray.
TEST(Mis, LeavesWholeWhatOnlyOneStrategyFinds) {
    for (const real other : {real(0), real(1e-30), real(1), real(1e30), std::numeric_limits<real>::infinity()}) {
        EXPECT_EQ(lib::mis_weight_light(0, other), 1) << "a Dirac light has no density of its own";
        EXPECT_EQ(lib::mis_weight_bsdf(0, other), 1) << "nor has a Dirac direction";
    }
    for (const real density : {real(1e-30), real(1), real(1e30)}) {
        EXPECT_EQ(lib::mis_weight_light(density, 0), 1);
        EXPECT_EQ(lib::mis_weight_bsdf(density, 0), 1);
    }
}

// A density that is beyond all numbers takes all, and neither weight is ever no number.
TEST(Mis, OfDensitiesWithoutBoundIsZeroOrOne) {
    const real infinite = std::numeric_limits<real>::infinity(), largest = std::numeric_limits<real>::max(),
               least = std::numeric_limits<real>::min();
    for (const real density : {least, real(1), largest}) {
        EXPECT_EQ(lib::mis_weight_light(density, infinite), 0);
        EXPECT_EQ(lib::mis_weight_bsdf(density, infinite), 0);
        EXPECT_EQ(lib::mis_weight_light(infinite, density), 1);
        EXPECT_EQ(lib::mis_weight_bsdf(infinite, density), 1);
    }
    // Their sum and their ratio are too large for a number.
    EXPECT_EQ(lib::mis_weight_light(least, largest), 0);
    EXPECT_EQ(lib::mis_weight_light(largest, least), 1);
    EXPECT_EQ(lib::mis_weight_light(largest, largest), R(0.5));
    EXPECT_EQ(lib::mis_weight_bsdf(largest, largest), R(0.5));
}

// A light may be found from a vertex that two paths share in four ways. Those of BSDF sampling are weighed as
// kernels/stages/emission.cl and gradient_combine.cl do it, one weight after the other.
TEST(Mis, OfTwoPathsThatMergeSumsToOne) {
    std::mt19937_64 bits(1);
    std::uniform_real_distribution<double> exponent(-4, 4);
    for (int i = 0; i < 100'000; ++i) {
        // Of BSDF sampling over that of light sampling, and of the offset path over the base path up to there.
        const double base = i % 5 == 0 ? 0 : std::pow(10, exponent(bits)),
                     offset = i % 7 == 0    ? 0
                              : i % 11 == 0 ? base
                                            : std::pow(10, exponent(bits)),
                     ratio = std::pow(10, exponent(bits));
        double sum = lib::weight_of_light_at_shared_vertex(real(base), real(ratio * offset), real(ratio)) +
                     lib::weight_of_light_at_shared_vertex(real(offset), real(base / ratio), real(1 / ratio));
        for (const auto &[mine, other, prefix] : {std::tuple{base, offset, ratio}, {offset, base, 1 / ratio}})
            if (mine > 0)
                sum += lib::mis_weight_bsdf(real(mine), real(1)) / (1 + prefix * other / mine);
        ASSERT_NEAR(sum, 1, 16 * epsilon_of_real) << base << ' ' << offset << ' ' << ratio;
    }
}

TEST(Mis, AtSharedVerticesIsTheBalanceHeuristicOfEqualDensities) {
    for (const real bsdf : {real(0), real(1e-30), real(0.5), real(1e20)})
        for (const real ratio : {real(1e-10), real(1), real(1e10)}) {
            const double expected = 1 / (1 + double(bsdf) + ratio + double(bsdf) * ratio);
            EXPECT_NEAR(lib::weight_of_light_at_shared_vertex(bsdf, bsdf * ratio, ratio), expected,
                        8 * epsilon_of_real * expected);
        }
}

// An offset path that failed, or that is never sampled, leaves the base path its two samplers; and densities beyond all
// numbers leave light sampling nothing.
TEST(Mis, AtSharedVerticesHasLimits) {
    const real infinite = std::numeric_limits<real>::infinity();
    for (const real bsdf : {real(0), real(0.5), real(1e20), infinite})
        for (const real ratio : {real(-1), real(0)})
            EXPECT_FLOAT_EQ(lib::weight_of_light_at_shared_vertex(bsdf, 0, ratio), float(1 / (1 + r_min(bsdf, 1e30))));
    for (const real ratio : {std::numeric_limits<real>::min(), real(1), real(1e30)}) {
        EXPECT_LT(lib::weight_of_light_at_shared_vertex(infinite, infinite, ratio), 1e-20);
        EXPECT_EQ(lib::weight_of_light_at_shared_vertex(0, 0, ratio), 1 / (1 + ratio)) << "no BSDF sampling";
    }
}

// Of tests that compare strategies.
TEST(Mis, OfOneStrategyAloneCountsThatOneWhole) {
    for (const real light : {real(0), real(0.25), real(1e20)})
        for (const real bsdf : {real(0.5), real(1e-20)}) {
            EXPECT_EQ(lib::mis_weight_light_alone(light, bsdf), 1);
            EXPECT_EQ(lib::mis_weight_bsdf_not_at_all(bsdf, light), 0);
            EXPECT_EQ(lib::mis_weight_bsdf_alone(bsdf, light), 1);
        }
    EXPECT_EQ(lib::mis_weight_bsdf_not_at_all(0, 1), 1) << "what light sampling cannot find";
    EXPECT_EQ(lib::mis_weight_light_beside(0, 1), 1) << "what BSDF sampling cannot find";
}
