#include "runtime/film/block_test.h"

#include "runtime/error.h"
#include "runtime/film/distributions.h"
#include "tests/film/make_image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace gradus {
namespace {

constexpr std::uint32_t width = 72, height = 40; // the last row and column of blocks are smaller
constexpr double reference_spp = 4096, seed_spp = 16;

/// Synthetic renders of a smooth image whose noise has a known variance by pixel.
class Noise {
  public:
    explicit Noise(unsigned seed) : generator_(seed) {}

    /// The mean over `spp` samples a pixel. `bias` multiplies one block of 16 x 16, the second from the left on top.
    Image image(double spp, double bias = 1) {
        Image image = blank();
        for (Channel &channel : image.channels)
            for (std::size_t i = 0; i < channel.values.size(); ++i) {
                const std::size_t x = i % width, y = i / width;
                const double truth = radiance(i) * (x >= 16 && x < 32 && y < 16 ? bias : 1);
                channel.values[i] = float(truth + std::sqrt(sample_variance(i) / spp) * normal_(generator_));
            }
        return image;
    }

    /// Variance of the mean over `spp` samples.
    static Image variance(double spp) {
        Image image = blank();
        for (Channel &channel : image.channels)
            for (std::size_t i = 0; i < channel.values.size(); ++i)
                channel.values[i] = float(sample_variance(i) / spp);
        return image;
    }

    std::vector<Image> seeds(int count, double bias = 1) {
        std::vector<Image> images;
        for (int i = 0; i < count; ++i)
            images.push_back(image(seed_spp, bias));
        return images;
    }

  private:
    static Image blank() { return make_gray(width, height, std::vector<float>(width * height)); }
    static double radiance(std::size_t i) { return 0.5 + 0.4 * std::sin(0.1 * double(i % width)); }
    static double sample_variance(std::size_t i) { return radiance(i) * radiance(i); }

    std::mt19937 generator_;
    std::normal_distribution<double> normal_;
};

TEST(BlockTest, UnbiasedNoisePasses) {
    Noise noise(1);
    for (int trial = 0; trial < 20; ++trial) {
        const BlockTest test = block_z_test(noise.seeds(8), noise.image(reference_spp), Noise::variance(reference_spp),
                                            seed_spp, reference_spp, 16);
        EXPECT_TRUE(test.passed()) << "trial " << trial << ": largest " << test.largest << " of " << test.tested
                                   << ", over three " << test.over_three;
        EXPECT_EQ(test.tested, 3u * 5 * 3);
    }
}

TEST(BlockTest, AFivePercentErrorInOneBlockFails) {
    Noise noise(2);
    // One block is 256 pixels of 8 * 16 samples of relative deviation 1, so 0.05 is 9 standard errors.
    for (int trial = 0; trial < 10; ++trial) {
        const BlockTest test = block_z_test(noise.seeds(8, 1.05), noise.image(reference_spp),
                                            Noise::variance(reference_spp), seed_spp, reference_spp, 16);
        EXPECT_FALSE(test.passed());
        EXPECT_EQ(test.largest_index % 15, 1u) << "the block is not the biased one";
        EXPECT_GT(test.z[1], 4.5);
    }
}

// A renderer that is noisier than the reference's, everywhere alike or in the left half only, is still unbiased.
TEST(BlockTest, NoisierButUnbiasedImagesAreNotRefused) {
    for (const bool everywhere : {true, false}) {
        Noise noise(7);
        std::size_t tested = 0, over_two = 0, over_three = 0;
        for (int trial = 0; trial < 60; ++trial) {
            std::vector<Image> seeds = noise.seeds(8);
            const std::vector<Image> noisy = [&] {
                std::vector<Image> images;
                for (int i = 0; i < 8; ++i)
                    images.push_back(noise.image(seed_spp / 9));
                return images;
            }();
            for (std::size_t s = 0; s < seeds.size(); ++s)
                for (std::size_t c = 0; c < 3; ++c)
                    for (std::size_t i = 0; i < seeds[s].channels[c].values.size(); ++i)
                        if (everywhere || i % width < width / 2)
                            seeds[s].channels[c].values[i] = noisy[s].channels[c].values[i];
            const BlockTest test = block_z_test(seeds, noise.image(reference_spp), Noise::variance(reference_spp),
                                                seed_spp, reference_spp, 8);
            tested += test.tested;
            over_three += test.over_three;
            for (const double z : test.z)
                over_two += std::abs(z) > 2 ? 1 : 0;
        }
        const double expected = 2 * normal_upper_tail(2) * double(tested);
        EXPECT_LT(double(over_two), expected + 4 * std::sqrt(expected)) << (everywhere ? "everywhere" : "left half");
        EXPECT_LE(over_three, binomial_limit(tested, 2 * normal_upper_tail(3), 1e-3))
            << (everywhere ? "everywhere" : "left half");
    }
}

// With nothing known of the reference's noise the scores are Student's t; turned into normal quantiles they must be
// standard normal, whatever the number of seeds.
TEST(BlockTest, ScoresOfFewSeedsAreStandardNormal) {
    for (const int count : {2, 3, 8}) {
        Noise noise(3 + unsigned(count));
        const Image exact = noise.image(1e30);
        std::size_t tested = 0, over_two = 0, over_three = 0;
        for (int trial = 0; trial < 60; ++trial) {
            const BlockTest test = block_z_test(noise.seeds(count), exact, Image(), 0, 0, 16);
            tested += test.tested;
            over_three += test.over_three;
            for (const double z : test.z)
                over_two += std::abs(z) > 2 ? 1 : 0;
        }
        const double chance_two = 2 * normal_upper_tail(2), expected = chance_two * double(tested);
        EXPECT_NEAR(double(over_two), expected, 4 * std::sqrt(expected * (1 - chance_two))) << count << " seeds";
        EXPECT_LE(over_three, binomial_limit(tested, 2 * normal_upper_tail(3), 1e-4)) << count << " seeds";
    }
}

// Seeds that by chance agree too well must not make a difference significant.
TEST(BlockTest, TheReferencesVarianceIsAFloor) {
    Noise noise(4);
    const Image same = noise.image(seed_spp), reference = noise.image(reference_spp);
    const std::vector<Image> seeds(4, same); // sample variance 0
    const BlockTest without = block_z_test(seeds, reference, Image(), 0, 0, 16);
    EXPECT_FALSE(without.passed());
    const BlockTest with = block_z_test({same}, reference, Noise::variance(reference_spp), seed_spp, reference_spp, 16);
    EXPECT_TRUE(with.passed()) << with.largest;
    // Four equal seeds count as four: the floor is a quarter of that of one.
    const BlockTest four = block_z_test(seeds, reference, Noise::variance(reference_spp), seed_spp, reference_spp, 16);
    const double per_pixel_seed = with.standard_error[0] * with.standard_error[0];
    const double per_pixel_four = four.standard_error[0] * four.standard_error[0];
    const double ratio = reference_spp / seed_spp;
    EXPECT_NEAR(per_pixel_seed / per_pixel_four, (ratio + 1) / (ratio / 4 + 1), 1e-3);
}

TEST(BlockTest, StandardErrorOfHandComputedValues) {
    // Two pixels, one block: seeds' means 1.5 and 2.5, so the variance of their mean is 0.5 / 2; the reference's is
    // (0.02 + 0.06) / 4.
    const Image first = make_image(2, 1, {{"Y", {1, 2}}}), second = make_image(2, 1, {{"Y", {2, 3}}});
    const Image reference = make_image(2, 1, {{"Y", {1, 1}}}), variance = make_image(2, 1, {{"Y", {0.02f, 0.06f}}});
    const BlockTest test = block_z_test({first, second}, reference, variance, 0, 0, 0);
    ASSERT_EQ(test.z.size(), 1u);
    EXPECT_NEAR(test.difference[0], 1, 1e-12);
    EXPECT_NEAR(test.standard_error[0], std::sqrt(0.25 + 0.02), 1e-6);
    const double freedom = 0.27 * 0.27 / (0.25 * 0.25 / 1 + 0.02 * 0.02 / 63);
    EXPECT_NEAR(test.z[0], student_to_normal(1 / std::sqrt(0.27), freedom), 1e-5);
    // With counts the floor is 0.02 * 100 / (2 * 4) = 0.25 of the same size; a larger ratio takes over.
    const BlockTest floor = block_z_test({first, second}, reference, variance, 4, 200, 0);
    EXPECT_NEAR(floor.standard_error[0], std::sqrt(0.5 + 0.02), 1e-6);
}

TEST(BlockTest, WhatDoesNotVaryIsLeftOutWhereEqualAndFailsWhereNot) {
    const Image black = make_gray(2, 2, {0, 0, 0, 0}), none = black;
    const BlockTest equal = block_z_test({black, black}, black, none, 1, 1, 1);
    EXPECT_EQ(equal.tested, 0u);
    EXPECT_FALSE(equal.passed()) << "nothing was tested, so nothing was shown";
    const Image faint = make_gray(2, 2, {1e-24f, 0, 0, 0}); // its variance is not a float
    EXPECT_EQ(block_z_test({black, black}, faint, none, 1, 1, 1).tested, 0u);
    const Image light = make_gray(2, 2, {0, 17, 17, 17}), other = make_gray(2, 2, {0, 17.00001f, 17, 17.1f});
    const BlockTest wrong = block_z_test({other, other}, light, none, 1, 1, 1);
    EXPECT_EQ(wrong.tested, 3u) << "only the pixel of 17.1 of each channel differs by more than rounding";
    EXPECT_GT(wrong.largest, 30);
}

TEST(BlockTest, NonFiniteBlocksFail) {
    Noise noise(5);
    std::vector<Image> seeds = noise.seeds(8);
    seeds[3].channels[1].values[0] = std::numeric_limits<float>::quiet_NaN();
    const BlockTest test =
        block_z_test(seeds, noise.image(reference_spp), Noise::variance(reference_spp), seed_spp, reference_spp, 16);
    EXPECT_EQ(test.non_finite, 1u);
    EXPECT_EQ(test.tested, 44u);
    EXPECT_FALSE(test.passed());
}

TEST(BlockTest, OneSeedNeedsAVarianceAndCounts) {
    Noise noise(6);
    const std::vector<Image> one = noise.seeds(1);
    EXPECT_THROW(block_z_test(one, one[0], Image(), 1, 1, 16), Error);
    EXPECT_THROW(block_z_test(one, one[0], Noise::variance(1), 0, 1, 16), Error);
    EXPECT_NO_THROW(block_z_test(one, one[0], Noise::variance(1), 1, 1, 16));
    EXPECT_THROW(block_z_test(one, make_gray(1, 1, {1}), Noise::variance(1), 1, 1, 16), Error);
}

} // namespace
} // namespace gradus
