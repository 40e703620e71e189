#define MANY_LIGHTS 1
#include <gtest/gtest.h>

// After GoogleTest, which has template parameters of the names of its macros.
#include "kernels/lib/light_draw.h"
#include "kernels/lib/random.h"
#include "runtime/scene/light_table.h"

#include <cmath>
#include <cstdio>
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

// What kernels draw of a million lights: with a column by 24 bits chi-square is 9 standard deviations too large.
TEST(LightDraw, IsEvenAmongAMillionLights) {
    constexpr std::uint32_t count = 1'000'000, draws = 24'000'000;
    std::mt19937 engine(5);
    std::vector<double> weights(count);
    double total = 0;
    for (double &weight : weights)
        total += weight = 1 + 2e-9 * engine();
    const AliasTable table = make_alias_table(weights);
    std::vector<std::uint32_t> found(count, 0);
    for (std::uint32_t i = 0; i < draws; ++i) {
        const lib_float::random4 u = lib_float::random_draw(i, 11, 1);
        const lib_float::light_drawn drawn = lib_float::light_draw(u.a, u.b, count);
        ASSERT_LT(drawn.column, count);
        ++found[drawn.keeps < table.threshold[drawn.column] ? drawn.column : table.alias[drawn.column]];
    }
    double chi_square = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const double expected = weights[i] / total * draws;
        chi_square += (found[i] - expected) * (found[i] - expected) / expected;
    }
    const double z = (chi_square - (count - 1)) / std::sqrt(2.0 * (count - 1));
    std::printf("a million lights: chi-square %.0f, z %.2f\n", chi_square, z);
    EXPECT_LT(std::fabs(z), 5);
}

// The ends of the range, at counts up to the largest.
TEST(LightDraw, ReachesEveryLight) {
    const float last = 1 - 0x1p-24f;
    for (const std::uint32_t count : {4097u, 1'000'003u, 16'777'217u, 300'000'001u, 0xFFFFFFFFu}) {
        EXPECT_EQ(lib_float::light_draw(0, 0, count).column, 0u);
        EXPECT_EQ(lib_float::light_draw(last, last, count).column, count - 1);
        // The one in the middle by the first number that reaches it.
        const std::uint32_t middle = count / 2 + 1;
        const std::uint64_t first = ((static_cast<unsigned __int128>(middle) << 48) + count - 1) / count;
        const auto a = float(first >> 24) * 0x1p-24f, b = float(first & 0xFFFFFFu) * 0x1p-24f;
        EXPECT_EQ(lib_float::light_draw(a, b, count).column, middle) << count;
    }
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
