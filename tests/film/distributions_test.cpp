#include "runtime/film/distributions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace gradus {
namespace {

TEST(Distributions, NormalTailsOfTables) {
    EXPECT_NEAR(normal_upper_tail(0), 0.5, 1e-15);
    EXPECT_NEAR(normal_upper_tail(1.959963984540054), 0.025, 1e-14);
    EXPECT_NEAR(normal_upper_tail(5) / 2.866515718791939e-7, 1, 1e-10);
}

TEST(Distributions, NormalQuantileInvertsTheTail) {
    for (const double z : {0.001, 0.5, 1.0, 3.0, 8.0, 20.0, 36.0})
        EXPECT_NEAR(normal_quantile_of_tail(normal_upper_tail(z)), z, 1e-9);
    EXPECT_NEAR(normal_quantile_of_tail(0), normal_quantile_of_tail(1e-300), 1e-12);
}

TEST(Distributions, StudentTailsAgreeWithClosedForms) {
    for (const double t : {0.0, 0.3, 1.0, 2.5, 12.706, 1e3, 1e6}) {
        // One degree of freedom is Cauchy's; acot keeps its digits far out. Two have a closed form too.
        EXPECT_NEAR(student_upper_tail(t, 1) / (std::atan2(1, t) / std::numbers::pi), 1, 1e-11) << t;
        const double root = std::sqrt(2 + t * t), two = 1 / (root * (root + t));
        EXPECT_NEAR(student_upper_tail(t, 2) / two, 1, 1e-11) << t;
    }
    EXPECT_NEAR(student_upper_tail(2.364624251592784, 7), 0.025, 1e-12);
}

TEST(Distributions, StudentTailIsTheIntegralOfTheDensity) {
    const double degrees = 4.7;
    const double constant =
        std::exp(std::lgamma((degrees + 1) / 2) - std::lgamma(degrees / 2)) / std::sqrt(degrees * std::numbers::pi);
    const auto density = [&](double x) { return constant * std::pow(1 + x * x / degrees, -(degrees + 1) / 2); };
    // Simpson's rule from 0 to 1.8.
    const int steps = 1000;
    double sum = density(0) + density(1.8);
    for (int i = 1; i < steps; ++i)
        sum += density(1.8 * i / steps) * (i % 2 == 1 ? 4 : 2);
    EXPECT_NEAR(student_upper_tail(1.8, degrees), 0.5 - sum * 1.8 / steps / 3, 1e-11);
}

TEST(Distributions, StudentToNormal) {
    EXPECT_NEAR(student_to_normal(2.364624251592784, 7), 1.959963984540054, 1e-9);
    EXPECT_NEAR(student_to_normal(-2.364624251592784, 7), -1.959963984540054, 1e-9);
    EXPECT_DOUBLE_EQ(student_to_normal(4.2, std::numeric_limits<double>::infinity()), 4.2);
    EXPECT_NEAR(student_to_normal(5, 1e7), 5, 1e-4);
    EXPECT_LT(student_to_normal(25, 7), 8);
    EXPECT_GT(student_to_normal(25, 7), 5);
    EXPECT_NEAR(student_to_normal(0, 7), 0, 1e-9);
    EXPECT_TRUE(std::isfinite(student_to_normal(1e200, 63)));
}

TEST(Distributions, SidakLimit) {
    EXPECT_NEAR(sidak_limit(1, 0.05), 1.959963984540054, 1e-9);
    // The chance that all of 209 stay below is 0.999.
    const double limit = sidak_limit(209, 0.001);
    EXPECT_NEAR(std::pow(1 - 2 * normal_upper_tail(limit), 209), 0.999, 1e-9);
}

TEST(Distributions, BinomialLimit) {
    // Ten fair coins: more than 8 heads in 11 of 1024, more than 9 in 1 of 1024.
    EXPECT_EQ(binomial_limit(10, 0.5, 0.011), 8u);
    EXPECT_EQ(binomial_limit(10, 0.5, 0.0107), 9u);
    EXPECT_EQ(binomial_limit(0, 0.5, 0.001), 0u);
    // Where the normal approximation takes over.
    EXPECT_NEAR(double(binomial_limit(10000000, 0.0027, 0.001)), 27000 + 3.09 * std::sqrt(27000.0), 10);
}

} // namespace
} // namespace gradus
