// The float build of the shifts against the double build of the same source, on arguments that float holds exactly.
#include "tests/kernels/shift_case.h"
#include "tests/kernels/shift_functions.h"
#include "tests/support/stability.h"
#include "tests/support/worse.h"

#include <algorithm>
#include <cstdio>
#include <gtest/gtest.h>

using namespace gradus::testing;

namespace {

std::array<double, 3> rounded(LongVector v) { return {float(v.x), float(v.y), float(v.z)}; }

HalfVectorArguments arguments_of(const ShiftCase &c) {
    return {rounded(c.wi_base), rounded(c.wo_base), rounded(c.wi_offset), c.ior_base, c.ior_offset};
}

double distance(const std::array<double, 3> &a, const std::array<double, 3> &b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

constexpr const char *float_against_double = "float: what is left where terms cancel";

} // namespace

// Edges: a cosine at the target below 0.01, where n.d is what is left of terms a hundred times larger.
TEST(ShiftPrecision, ReconnectionInFloatMatchesDouble) {
    ShiftCases draws(1, 0.01);
    double largest = 0;
    int count = 0;
    for (int i = 0; i < 500'000; ++i) {
        const LongVector target = 10.0L * draws.draw_direction(), normal = draws.draw_direction();
        const LongVector to_base = draws.draw_direction(), to_offset = draws.draw_direction();
        if (std::min(std::fabs(dot(to_base, normal)), std::fabs(dot(to_offset, normal))) < 0.011L)
            continue;
        // The shorter distance is what rounding leaves of it: both builds see the rounded positions.
        const auto end = [&](LongVector direction) {
            return rounded(target + (long double)(std::pow(10.0, -3 + 7 * draws.uniform())) * direction);
        };
        const ReconnectionArguments a{end(to_base), end(to_offset), rounded(target), rounded(normal)};
        const double exact = shifts_in_double.reconnection(a), approximate = shifts_in_float.reconnection(a);
        ASSERT_GT(exact, 0);
        largest = worse(largest, std::fabs(approximate / exact - 1));
        ++count;
    }
    std::printf("  %d reconnections, largest error %.1e\n", count, largest);
    EXPECT_GT(count, 400'000);
    record_stability({"Numbers", float_against_double,
                      "reconnections over distances from 1e-3 to 1e4, cosines over 0.01", "float all through",
                      "largest relative error of the Jacobian", largest, 1e-4});
}

// Edges: a cosine against the microfacet below 0.1 (near total reflection root^2 is known to some 1e-7, the Jacobian to
// that over root^2), and half vectors shorter than 0.2 (their normal is known to 1e-7 / |h|).
TEST(ShiftPrecision, HalfVectorInFloatMatchesDouble) {
    ShiftCases draws(2, 0.0101);
    double largest = 0, largest_direction = 0, largest_edge = 0;
    int count = 0, edges = 0, differing = 0;
    for (int i = 0; i < 300'000; ++i) {
        const ShiftCase c = draws.draw();
        const HalfVectorArguments a = arguments_of(c);
        const ShiftResult exact = shifts_in_double.half_vector(a), approximate = shifts_in_float.half_vector(a);
        if (exact.is_valid != approximate.is_valid) {
            ++differing;
            EXPECT_LT(c.microfacet_cosine(), 0.011);
            continue;
        }
        const double error = exact.is_valid ? std::fabs(approximate.jacobian / exact.jacobian - 1) : 0;
        if (c.microfacet_cosine() < 0.1 || c.half_vector_length() < 0.2) {
            ++edges;
            largest_edge = worse(largest_edge, error);
            continue;
        }
        ++count;
        largest = worse(largest, error);
        largest_direction = worse(largest_direction, distance(exact.wo, approximate.wo));
    }
    std::printf("  %d copies: Jacobian %.1e, direction %.1e; %d at the edges: %.1e, success differs for %d\n", count,
                largest, largest_direction, edges, largest_edge, differing);
    EXPECT_GT(count, 50'000);
    EXPECT_LT(largest_direction, 1e-4);
    EXPECT_LT(differing, 300);
    record_stability({"Numbers", float_against_double, "half-vector copies away from edges", "float all through",
                      "largest relative error of the Jacobian", largest, 1e-4});
    record_stability(
        {"Numbers", float_against_double,
         "half-vector copies at a cosine of 0.01 to 0.1 against the microfacet, or with a short half vector",
         "float all through; fails at smaller cosines", "largest relative error of the Jacobian", largest_edge, 2e-2});
}

TEST(ShiftPrecision, SpecularInFloatMatchesDouble) {
    ShiftCases draws(3, 0.1);
    double largest = 0;
    for (int i = 0; i < 300'000; ++i) {
        const HalfVectorArguments a = arguments_of(draws.draw());
        const ShiftResult exact = shifts_in_double.specular(a), approximate = shifts_in_float.specular(a);
        // Within 0.1 of total reflection the direction is known to 1e-7 / 0.1 at best, and success may differ.
        if (std::fabs(exact.wo[2]) < 0.1 && std::fabs(approximate.wo[2]) < 0.1)
            continue;
        ASSERT_EQ(exact.is_valid, approximate.is_valid);
        largest = worse(largest, distance(exact.wo, approximate.wo));
    }
    std::printf("  largest error of a direction %.1e\n", largest);
    record_stability({"Numbers", float_against_double, "shifts at Dirac vertices", "float all through",
                      "largest error of a direction", largest, 1e-5});
}
