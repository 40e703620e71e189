// Each warp sends the uniform square to its density: mapped back by the closed-form inverse it must be uniform again.
#include "tests/kernels/precision.h"
#include "tests/support/chi_square.h"

#include <functional>
#include <gtest/gtest.h>
#include <random>

using namespace gradus::testing;

namespace {

constexpr int resolution = 32;
constexpr int chi_square_tests = 8; // calls below, for the Sidak level

struct Square {
    double a, b;
};

/// Draws samples, maps each back to the unit square and tests for uniformity there.
void expect_uniform(const std::function<Square(real, real)> &there_and_back) {
    std::mt19937_64 random(7);
    std::uniform_int_distribution<int> bits(0, (1 << 24) - 1);
    std::vector<double> counts(resolution * resolution);
    for (int i = 0; i < sample_count; ++i) {
        const real u1 = static_cast<real>(std::ldexp(bits(random), -24));
        const real u2 = static_cast<real>(std::ldexp(bits(random), -24));
        const Square back = there_and_back(u1, u2);
        ASSERT_GE(std::min(back.a, back.b), -1e-6);
        ASSERT_LE(std::max(back.a, back.b), 1 + 1e-6);
        const auto cell = [](double x) { return std::clamp(static_cast<int>(x * resolution), 0, resolution - 1); };
        counts[cell(back.a) * resolution + cell(back.b)] += 1;
    }
    const std::vector<double> expected(counts.size(), sample_count / double(counts.size()));
    EXPECT_GT(chi_square(counts, expected).p_value, sidak_level(1e-3, chi_square_tests));
}

double turn(double x, double y) {
    const double turns = std::atan2(y, x) / (2 * M_PI);
    return turns < 0 ? turns + 1 : turns;
}

} // namespace

TEST(Warp, UniformDisk) {
    expect_uniform([](real u1, real u2) {
        const lib::point2 p = lib::warp_uniform_disk(u1, u2);
        return Square{double(p.x) * p.x + double(p.y) * p.y, turn(p.x, p.y)};
    });
}

TEST(Warp, CosineHemisphere) {
    expect_uniform([](real u1, real u2) {
        const lib::vec3 w = lib::warp_cosine_hemisphere(u1, u2);
        EXPECT_NEAR(lib::v3_length_squared(w), 1, bound(5e-7, 1e-15));
        EXPECT_GT(w.z, 0);
        return Square{double(w.z) * w.z, turn(w.x, w.y)};
    });
    EXPECT_NEAR(lib::warp_cosine_hemisphere_pdf(R(0.5)), 0.5 / M_PI, 1e-7);
    EXPECT_EQ(lib::warp_cosine_hemisphere_pdf(R(-0.5)), 0);
}

TEST(Warp, UniformSphere) {
    expect_uniform([](real u1, real u2) {
        const lib::vec3 w = lib::warp_uniform_sphere(u1, u2);
        EXPECT_NEAR(lib::v3_length_squared(w), 1, bound(5e-7, 1e-15));
        return Square{0.5 + 0.5 * w.z, turn(w.x, w.y)};
    });
    EXPECT_NEAR(lib::warp_uniform_sphere_pdf() * 4 * M_PI, 1, 1e-6);
}

TEST(Warp, UniformConeWideAndTiny) {
    for (const double angle : {3.0, 1.0, 1e-2, 1e-4}) {
        const double depth = 2 * std::pow(std::sin(0.5 * angle), 2); // 1 - cos(angle)
        expect_uniform([&](real u1, real u2) {
            const lib::vec3 w = lib::warp_uniform_cone(real(depth), u1, u2);
            EXPECT_NEAR(lib::v3_length_squared(w), 1, bound(5e-7, 1e-15));
            // 1 - cos from the sine: float cannot hold 1 - cos of a tiny cone in w.z.
            const double sine = std::hypot(double(w.x), double(w.y));
            const double reached = angle > 0.5 ? 1 - double(w.z) : sine * sine / (1 + std::sqrt(1 - sine * sine));
            return Square{reached / depth, turn(w.x, w.y)};
        });
        EXPECT_NEAR(lib::warp_uniform_cone_pdf(real(depth)) * 2 * M_PI * depth, 1, 1e-6);
    }
}

TEST(Warp, OneMinusCosineKeepsItsDigits) {
    for (const double sine : {1e-10, 1e-5, 1e-3, 0.1, 0.9, 1.0}) {
        const double exact = 2 * std::pow(std::sin(0.5 * std::asin(sine)), 2);
        EXPECT_NEAR(lib::warp_one_minus_cosine(real(sine * sine)) / exact, 1, bound(3e-7, 1e-14)) << sine;
    }
}

TEST(Warp, UniformTriangle) {
    expect_uniform([](real u1, real u2) {
        const lib::point2 b = lib::warp_uniform_triangle(u1, u2);
        EXPECT_GE(b.x, 0);
        EXPECT_GE(b.y, 0);
        EXPECT_LE(b.x + b.y, 1 + 1e-6);
        // Area left of b.x, and the place along the line b.x = const.
        const double rest = 1 - double(b.x);
        return Square{rest * rest, rest > 0 ? b.y / rest : 0};
    });
}

TEST(Frame, IsOrthonormalAndRightHandedEverywhere) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const double tolerance = bound(1e-6, 1e-14);
    for (int i = 0; i < 20'000; ++i) {
        // Every third normal is close to -z, where the older formula without the sign breaks down.
        const double squeeze = i % 3 == 0 ? std::pow(10.0, -(i % 8)) : 1;
        double n[3] = {uniform(random) * squeeze, uniform(random) * squeeze, i % 3 == 0 ? -1.0 : uniform(random)};
        const double length = std::hypot(n[0], n[1], n[2]);
        const lib::frame f =
            lib::frame_from_normal(lib::v3(real(n[0] / length), real(n[1] / length), real(n[2] / length)));
        for (const double product : {lib::v3_dot(f.s, f.t), lib::v3_dot(f.s, f.n), lib::v3_dot(f.t, f.n)})
            ASSERT_NEAR(product, 0, tolerance);
        for (const double square : {lib::v3_dot(f.s, f.s), lib::v3_dot(f.t, f.t)})
            ASSERT_NEAR(square, 1, tolerance);
        ASSERT_NEAR(lib::v3_dot(lib::v3_cross(f.s, f.t), f.n), 1, tolerance);
        const lib::vec3 v = lib::v3(R(0.25), R(-0.5), R(0.75));
        const lib::vec3 back = lib::frame_to_local(f, lib::frame_to_world(f, v));
        ASSERT_NEAR(back.x, v.x, tolerance);
        ASSERT_NEAR(back.y, v.y, tolerance);
        ASSERT_NEAR(back.z, v.z, tolerance);
    }
    for (const real z : {R(1), R(-1)})
        ASSERT_EQ(lib::frame_from_normal(lib::v3(0, 0, z)).n.z, z);
}
