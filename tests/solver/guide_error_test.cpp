// What two halves tell of the error of an image, where the truth is known.
#include "solver/guide/guide_judge.h"
#include "solver/guide/guided_errors.h"
#include "tests/solver/solver_fixture.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace gradus::testing {
namespace {

/// A constant image of three channels, of which two halves have noise by pixel of a standard deviation that goes over
/// two orders of magnitude from left to right, and what follows such an image: a guide with a bias, and noise of which
/// some is the half's own.
struct ErrorCase {
    double share = 0.5;       ///< of the first half
    double guide_bias = 0;    ///< from left to right, from none on
    double guide_noise = 0.1; ///< of its own, of the image's
    double common = 0;        ///< of the half's noise that is in its guide
};

class KnownErrors {
  public:
    static constexpr std::uint32_t width = 128, height = 96;
    static constexpr std::size_t pixels = std::size_t(width) * height;
    static constexpr float truth = 1;
    using Halves = std::array<std::vector<float>, 2>;

    KnownErrors(const ErrorCase &c, unsigned seed) : case_(c) {
        std::mt19937 generator(seed);
        std::normal_distribution<double> normal;
        for (int half = 0; half < 2; ++half) {
            const double part = half == 0 ? c.share : 1 - c.share;
            for (std::size_t i = 0; i < 3 * pixels; ++i) {
                const double across = double(i % width) / width;
                const double sigma = 0.02 * std::pow(10.0, across) / std::sqrt(part);
                const double noise = sigma * normal(generator);
                halves[half].push_back(float(truth + noise));
                guides[half].push_back(float(truth + c.guide_bias * across + c.common * noise +
                                             c.guide_noise * sigma * normal(generator)));
            }
        }
    }

    /// The image and the errors that its halves tell.
    void follow() {
        std::array<Buffer, 2> images, followed;
        for (int half = 0; half < 2; ++half) {
            images[half] = uploaded(halves[half]);
            followed[half] = uploaded(guides[half]);
        }
        Buffer result(test_device(), "result", 3 * pixels * sizeof(float));
        GuideJudge judge(test_device(), width, height);
        std::vector<float> shares;
        judge.run({&images[0], &images[1]}, case_.share, {&followed[0], &followed[1]}, result, nullptr, &shares);
        image.resize(3 * pixels);
        result.read(image.data(), result.bytes());
        errors = errors_of_guided({&images[0], &images[1]}, case_.share, {&followed[0], &followed[1]}, shares);
        for (std::size_t i = 0; i < 3 * pixels; ++i) { // the image is what the shares say
            const double own = mean(halves, i), guide = mean(guides, i), share = shares[i % pixels];
            ASSERT_NEAR(image[i], own + share * (guide - own), 1e-5) << i;
        }
    }

    double mean(const Halves &of, std::size_t i) const { return case_.share * of[0][i] + (1 - case_.share) * of[1][i]; }

    Halves halves, guides;
    std::vector<float> image;
    SquaredErrors errors;

  private:
    static Buffer uploaded(const std::vector<float> &values) {
        return Buffer(test_device(), "image", values.data(), values.size() * sizeof(float));
    }
    ErrorCase case_;
};

/// Means over some thousand pixels of both: with so many normal numbers the means of squares are known to 2 %, three
/// standard errors, and their ratio to 3 %.
TEST(SquaredErrors, OfHalvesAreTheVarianceOfTheirMean) {
    for (const double share : {0.5, 0.3, 0.8}) {
        KnownErrors known({.share = share}, 1);
        const SquaredErrors errors = errors_of_halves(known.halves[0], known.halves[1], share);
        EXPECT_TRUE(errors.bias.empty());
        double told = 0, true_errors = 0;
        for (std::size_t i = 0; i < errors.variance.size(); ++i) {
            const double sigma = 0.02 * std::pow(10.0, double(i % KnownErrors::width) / KnownErrors::width);
            told += errors.variance[i] / (sigma * sigma);
            true_errors += std::pow((known.mean(known.halves, i) - KnownErrors::truth) / sigma, 2);
        }
        const double count = double(errors.variance.size());
        EXPECT_NEAR(told / count, 1, 0.03) << share;
        EXPECT_NEAR(true_errors / count, 1, 0.03) << share;
    }
}

class GuidedErrors : public ::testing::TestWithParam<ErrorCase> {};

/// In each fifth of the image, from little noise to much, as shares of the variance V without a guide. A bias is told
/// by the difference of two squares of normal numbers, which has a standard deviation of 2 V; of 86000 such values,
/// whose V goes over a factor of 2.5, the mean is known to 0.0078, and four standard errors are 0.031. The share is
/// made of the same noise, of some 340 values, and so is larger where less was lost by chance: that is a hundredth or
/// two.
TEST_P(GuidedErrors, AreThoseOfTheTruth) {
    constexpr int parts = 5, seeds = 12;
    std::array<double, parts> told{}, right{}, unguided{};
    for (unsigned seed = 0; seed < seeds; ++seed) {
        KnownErrors known(GetParam(), 10 + seed);
        known.follow();
        for (std::size_t i = 0; i < known.image.size(); ++i) {
            const std::size_t part = i % KnownErrors::width * parts / KnownErrors::width;
            told[part] += known.errors.variance[i] + known.errors.bias[i];
            right[part] += std::pow(known.image[i] - KnownErrors::truth, 2);
            unguided[part] += std::pow(known.mean(known.halves, i) - KnownErrors::truth, 2);
        }
    }
    for (int part = 0; part < parts; ++part)
        EXPECT_NEAR(told[part] / unguided[part], right[part] / unguided[part], 0.05) << part;
}

INSTANTIATE_TEST_SUITE_P(Cases, GuidedErrors,
                         ::testing::Values(ErrorCase{}, ErrorCase{.share = 0.3}, ErrorCase{.guide_bias = 0.1},
                                           ErrorCase{.guide_bias = 0.3}, ErrorCase{.common = 0.5},
                                           ErrorCase{.guide_bias = 0.1, .guide_noise = 0.3, .common = 0.3}));

} // namespace
} // namespace gradus::testing
