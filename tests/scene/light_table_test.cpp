#include "runtime/scene/light_table.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace gradus {
namespace {

/// What a uniform column and a second draw give each entry, in double.
std::vector<double> drawn_shares(const AliasTable &table) {
    const double column = 1.0 / double(table.threshold.size());
    std::vector<double> share(table.threshold.size());
    for (std::size_t i = 0; i < share.size(); ++i) {
        share[i] += column * table.threshold[i];
        share.at(table.alias[i]) += column * (1 - double(table.threshold[i]));
    }
    return share;
}

void expect_exact(const std::vector<double> &weights) {
    const AliasTable table = make_alias_table(weights);
    ASSERT_EQ(table.probability.size(), weights.size());
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    const std::vector<double> share = drawn_shares(table);
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double expected = weights[i] / total;
        EXPECT_GE(table.threshold[i], 0);
        EXPECT_LE(table.threshold[i], 1);
        EXPECT_LT(table.alias[i], weights.size());
        // Thresholds are floats: half a unit in the last place of 1 a column, each way.
        EXPECT_NEAR(share[i], expected, 6e-8) << "entry " << i << " of " << weights.size();
        EXPECT_NEAR(table.probability[i], expected, 6e-8 * expected);
        if (weights[i] == 0) { // would be divided by its probability
            EXPECT_EQ(share[i], 0) << "entry " << i;
        }
    }
}

TEST(AliasTable, DrawsByWeight) {
    expect_exact({1});
    expect_exact({1, 1, 1, 1});
    expect_exact({1, 2, 3, 4});
    expect_exact({4, 3, 2, 1});
    expect_exact({1e-12, 1, 1e12});
    expect_exact({1000, 1, 1, 1, 1, 1, 1});
}

TEST(AliasTable, NeverDrawsWhatWeighsNothing) {
    expect_exact({0, 1});
    expect_exact({1, 0});
    expect_exact({0, 0, 5, 0, 0});
    expect_exact({0, 0.1, 0, 0.1, 0.1, 0, 0.1, 0, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0});
}

TEST(AliasTable, DrawsByManyWeights) {
    std::mt19937 engine(1);
    std::uniform_real_distribution<double> uniform;
    for (const std::size_t count : {2u, 3u, 17u, 1000u, 4096u}) {
        std::vector<double> weights(count);
        for (double &weight : weights)
            weight = uniform(engine) < 0.2 ? 0 : std::exp(10 * uniform(engine));
        weights.back() = 1;
        expect_exact(weights);
    }
}

} // namespace
} // namespace gradus
