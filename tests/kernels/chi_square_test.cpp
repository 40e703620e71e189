// The chi-square helper itself: known values, and that it tells a right sampler from a wrong one.
#include "tests/support/chi_square.h"

#include <gtest/gtest.h>
#include <random>

using namespace gradus::testing;

TEST(ChiSquare, IncompleteGammaMatchesClosedForms) {
    for (const double x : {0.01, 0.5, 1.0, 3.0, 20.0}) {
        EXPECT_NEAR(upper_incomplete_gamma(1, x), std::exp(-x), 1e-14);
        EXPECT_NEAR(upper_incomplete_gamma(0.5, x), std::erfc(std::sqrt(x)), 1e-13);
        EXPECT_NEAR(upper_incomplete_gamma(3, x), std::exp(-x) * (1 + x + x * x / 2), 1e-13);
    }
}

TEST(ChiSquare, PoolsCellsThatHoldTooLittle) {
    const ChiSquare result = chi_square({10, 1, 2, 3, 1}, {10, 1, 2, 3, 1});
    EXPECT_EQ(result.degrees_of_freedom, 1); // {1, 1, 2, 3} together, and 10
    EXPECT_EQ(result.statistic, 0);
    EXPECT_EQ(chi_square({0, 5}, {5, 0}).p_value, 1); // one pooled cell: nothing to say
}

TEST(ChiSquare, PassesTheRightDensityAndFailsOneThatIsOffByAFewPercent) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> uniform;
    const int cells = 50, samples = 200'000;
    std::vector<double> counts(cells), right(cells, samples / double(cells)), wrong(cells);
    for (int i = 0; i < samples; ++i)
        counts[static_cast<int>(uniform(random) * cells)] += 1;
    for (int i = 0; i < cells; ++i)
        wrong[i] = right[i] * (1 + 0.05 * ((i + 0.5) / cells - 0.5) * 2);
    EXPECT_GT(chi_square(counts, right).p_value, 1e-3);
    EXPECT_LT(chi_square(counts, wrong).p_value, 1e-6);
}

TEST(ChiSquare, SidakLevelKeepsTheFamily) {
    EXPECT_NEAR(1 - std::pow(1 - sidak_level(0.01, 200), 200), 0.01, 1e-12);
    EXPECT_DOUBLE_EQ(sidak_level(0.05, 1), 0.05);
}
