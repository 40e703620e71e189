// The variance of the mean of replicates, by all of their outcomes.
#include "runtime/film/replicates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace gradus {
namespace {

/// Replicates whose means are 2 - deviation or 2 + deviation, each with probability a half, the deviation being the
/// root of the variance: what variance_of_mean() is over the variance of their mean, both averaged over all outcomes.
double told_over_true(const std::vector<double> &counts, const std::vector<double> &variances) {
    double told = 0, truth = 0, all = 0;
    for (const double count : counts)
        all += count;
    const std::size_t outcomes = std::size_t(1) << counts.size();
    for (std::size_t outcome = 0; outcome < outcomes; ++outcome) {
        std::vector<Replicate> replicates;
        double mean = 0;
        for (std::size_t r = 0; r < counts.size(); ++r) {
            const double value = 2 + ((outcome >> r) % 2 == 0 ? -1 : 1) * std::sqrt(variances[r]);
            replicates.push_back({counts[r] * value, counts[r]});
            mean += counts[r] * value / all;
        }
        told += variance_of_mean(replicates);
        truth += (mean - 2) * (mean - 2);
    }
    return told / truth;
}

// Rounding alone is left: some 30 operations on 16 outcomes.
constexpr double rounding = 1e-13;

TEST(Replicates, TellTheVarianceOfTheirMeanWhateverTheirOwn) {
    EXPECT_NEAR(told_over_true({4, 4, 4, 4}, {1, 1, 1, 1}), 1, rounding);
    EXPECT_NEAR(told_over_true({4, 4, 4, 4}, {5, 0, 1, 0.1}), 1, rounding);
    EXPECT_NEAR(told_over_true({2, 1, 1, 1}, {0.1, 1, 1, 1}), 1, rounding);
    EXPECT_NEAR(told_over_true({2, 2, 2, 1}, {1, 1, 1, 9}), 1, rounding);
    EXPECT_NEAR(told_over_true({1, 1, 1, 0}, {1, 2, 3, 0}), 1, rounding);
    EXPECT_NEAR(told_over_true({9, 8, 8, 8, 8, 8, 8, 8}, {3, 1, 4, 1, 5, 9, 2, 6}), 1, rounding);
}

/// Two, or one with half of the samples or more: what one's spread hides the others do not show, so that variances must
/// be known to be as those of independent samples.
TEST(Replicates, OfWhichOneIsHalfOrMoreTellThatOfIndependentSamples) {
    EXPECT_NEAR(told_over_true({1, 1, 0, 0}, {1, 1, 0, 0}), 1, rounding);
    EXPECT_NEAR(told_over_true({5, 2, 1, 1}, {0.2, 0.5, 1, 1}), 1, rounding);
    EXPECT_NEAR(told_over_true({4, 2, 1, 1}, {0.25, 0.5, 1, 1}), 1, rounding);
}

TEST(Replicates, TellNothingOfOneSample) {
    EXPECT_EQ(variance_of_mean(std::vector<Replicate>{{3, 1}, {0, 0}, {0, 0}, {0, 0}}), 0);
    EXPECT_EQ(variance_of_mean(std::vector<Replicate>{{0, 0}, {0, 0}}), 0);
}

/// Light that does not vary, in float's sums: what counts are is no spread.
TEST(Replicates, OfOneValueHaveNoVariance) {
    const double value = double(0.1f);
    const double told = variance_of_mean(
        std::vector<Replicate>{{300001 * value, 300001}, {300001 * value, 300001}, {300000 * value, 300000}});
    EXPECT_LT(std::sqrt(told), 4 * std::numeric_limits<double>::epsilon() * value);
}

} // namespace
} // namespace gradus
