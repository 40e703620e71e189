// Guide images: the filter that makes them and the measure that decides how far they are followed.
#include "runtime/error.h"
#include "solver/guide/denoiser.h"
#include "solver/guide/feature_filter.h"
#include "solver/guide/guide_judge.h"
#include "solver/guide/light_correction.h"
#include "tests/solver/guide_reference.h"
#include "tests/solver/solver_fixture.h"
#include "tests/support/stability.h"
#include "tests/support/worse.h"

#include <gmock/gmock.h>

#include <random>

namespace gradus::testing {
namespace {

constexpr float missing_value = std::numeric_limits<float>::quiet_NaN();

/// A scene of three surfaces: two of them side by side in all features, the third with another normal; and light that
/// the features know nothing of.
struct Wall {
    GuideImage truth, features;
    Wall(int width, int height) : truth(width, height), features(width, height, 7) {
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const bool is_red = x > width / 3, is_floor = y > 2 * height / 3;
                const float light = 0.5f + 0.4f * std::sin(0.1f * float(x) + 0.05f * float(y));
                for (int c = 0; c < 3; ++c) {
                    features.at(c, x, y) = is_red && c > 0 ? 0.2f : 0.8f;
                    features.at(3 + c, x, y) = c == (is_floor ? 1 : 2) ? 1.0f : 0.0f;
                    truth.at(c, x, y) = features.at(c, x, y) * light * (is_floor ? 2.0f : 1.0f);
                }
                features.at(6, x, y) = 5.0f + 0.01f * float(x);
            }
    }
};

/// Two halves with independent noise of so large a standard deviation, relative to the value.
GuideHalves noisy(const GuideImage &truth, double sigma, unsigned seed, double share = 0.5) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    GuideHalves halves{truth, truth};
    for (int h = 0; h < 2; ++h)
        for (float &value : halves[h].values)
            value = float(value * (1 + sigma * normal(generator) / std::sqrt(h == 0 ? share : 1 - share)));
    return halves;
}

Buffer uploaded(const char *name, const GuideImage &image) {
    return Buffer(test_device(), name, image.values.data(), image.values.size() * sizeof(float));
}

GuideHalves filtered(const GuideHalves &halves, const GuideImage &features, double share = 0.5) {
    const int width = halves[0].width, height = halves[0].height;
    FeatureFilter filter(test_device(), width, height);
    const Buffer first = uploaded("first", halves[0]), second = uploaded("second", halves[1]);
    GuideHalves guides{GuideImage(width, height), GuideImage(width, height)};
    Buffer one = uploaded("one", guides[0]), two = uploaded("two", guides[1]);
    filter.run({&first, &second}, share, uploaded("features", features), {&one, &two});
    one.read(guides[0].values.data(), one.bytes());
    two.read(guides[1].values.data(), two.bytes());
    return guides;
}

GuideImage judged(const GuideHalves &halves, const GuideHalves &guides, double share = 0.5) {
    GuideImage result(halves[0].width, halves[0].height);
    GuideJudge judge(test_device(), result.width, result.height);
    const Buffer first = uploaded("first", halves[0]), second = uploaded("second", halves[1]);
    const Buffer one = uploaded("one", guides[0]), two = uploaded("two", guides[1]);
    Buffer written = uploaded("written", result);
    judge.run({&first, &second}, share, {&one, &two}, written);
    written.read(result.values.data(), written.bytes());
    return result;
}

/// With the light that was lost on the way.
GuideImage corrected(const GuideHalves &halves, GuideImage image) {
    const Buffer first = uploaded("first", halves[0]), second = uploaded("second", halves[1]);
    Buffer written = uploaded("image", image);
    LightCorrection(test_device(), std::uint32_t(image.width), std::uint32_t(image.height))
        .run({&first, &second}, 0.5, written);
    written.read(image.values.data(), written.bytes());
    return image;
}

GuideImage mean_of(const GuideHalves &halves, double share = 0.5) {
    GuideImage mean = halves[0];
    for (std::size_t i = 0; i < mean.values.size(); ++i)
        mean.values[i] = float(share * halves[0].values[i] + (1 - share) * halves[1].values[i]);
    return mean;
}

double squared_error(const GuideImage &image, const GuideImage &truth) {
    double sum = 0;
    for (std::size_t i = 0; i < truth.values.size(); ++i)
        sum += std::pow(double(image.values[i]) - truth.values[i], 2);
    return sum / double(truth.values.size());
}

double largest_difference(const GuideImage &a, const GuideImage &b) {
    double most = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        const double difference = std::abs(double(a.values[i]) - b.values[i]);
        most = difference <= most ? most : difference; // NaN is more than anything
    }
    return most;
}

/// Values are up to 4. A distance d is off by some ten roundings, relative, and by those of the values that it
/// compares: with noise of a fifth, one rounding is 1e-6 of what divides it. exp(-d) d is at most 0.4, so weights are
/// off by few of these and means by less.
constexpr double filter_rounding = 2e-5;

struct GuideCase {
    int width, height;
    double share;
};
void PrintTo(const GuideCase &c, std::ostream *out) { *out << c.width << "x" << c.height << ", " << c.share; }

class GuideSizes : public ::testing::TestWithParam<GuideCase> {};

TEST_P(GuideSizes, FilterIsThatOfTheReference) {
    const auto [width, height, share] = GetParam();
    const Wall wall(width, height);
    const GuideHalves halves = noisy(wall.truth, 0.2, 1, share);
    const GuideHalves guides = filtered(halves, wall.features, share);
    const GuideHalves expected = GuideReference(halves, share).filtered(wall.features);
    const double off = std::max(largest_difference(guides[0], expected[0]), largest_difference(guides[1], expected[1]));
    EXPECT_LE(off, filter_rounding);
    if (std::min(width, height) == 1)
        record_stability({"Reconstruction",
                          "1 x N images, of one pixel too: windows and patches that hang over each border",
                          "1 x 1, 2 x 1, 130 x 1 and 1 x 13 pixels, the feature filter",
                          "what is beyond the image counts for nothing", "largest difference from the filter in double",
                          off, filter_rounding});
}

TEST_P(GuideSizes, JudgementIsThatOfTheReference) {
    const auto [width, height, share] = GetParam();
    const Wall wall(width, height);
    const GuideHalves halves = noisy(wall.truth, 0.3, 2, share);
    GuideHalves guides = noisy(wall.truth, 0.05, 3, share);
    for (GuideImage &guide : guides)
        for (int x = width / 2; x < width; ++x)
            guide.at(0, x, 0) += 0.3f; // wrong in places
    // The share is a quotient of sums of a hundred terms; what is left of a loss after its error is off by the
    // rounding of both.
    EXPECT_LE(largest_difference(judged(halves, guides, share), GuideReference(halves, share).judged(guides)), 2e-5);
}

INSTANTIATE_TEST_SUITE_P(Sizes, GuideSizes,
                         ::testing::Values(GuideCase{70, 37, 0.5}, GuideCase{41, 29, 0.4}, GuideCase{1, 1, 0.5},
                                           GuideCase{2, 1, 0.5}, GuideCase{130, 1, 0.5}, GuideCase{1, 13, 0.5},
                                           GuideCase{64, 5, 0.5}));

TEST(GuideImages, WhatIsMissingGivesNothing) {
    const Wall wall(48, 32);
    GuideHalves halves = noisy(wall.truth, 0.2, 4);
    GuideImage features = wall.features;
    halves[0].at(1, 10, 10) = missing_value;
    halves[1].at(2, 0, 0) = std::numeric_limits<float>::infinity();
    for (int y = 20; y < 24; ++y)
        for (int x = 20; x < 24; ++x)
            halves[0].at(0, x, y) = missing_value;
    features.at(4, 30, 3) = features.at(6, 31, 3) = missing_value;
    const GuideReference reference(halves, 0.5);
    GuideHalves guides = filtered(halves, features);
    const GuideHalves expected = reference.filtered(features);
    EXPECT_LE(largest_difference(guides[0], expected[0]), filter_rounding);
    EXPECT_LE(largest_difference(guides[1], expected[1]), filter_rounding);
    guides[0].at(0, 40, 5) = missing_value;
    halves[1].at(0, 5, 25) = guides[1].at(1, 5, 25) = missing_value; // neither
    const GuideImage image = judged(halves, guides);
    EXPECT_EQ(count_non_finite(image.values), 0u);
    EXPECT_LE(largest_difference(image, reference.judged(guides)), 2e-5);
    EXPECT_EQ(image.at(0, 5, 25), 0.0f);
    record_stability({"Reconstruction", "a value that is not a number spoils all that are averaged with it",
                      "NaN and infinities in halves, features and guides",
                      "such pixels follow the guide, which their neighbours make", "values that are not finite",
                      double(count_non_finite(image.values)), 0});
}

// A render filters in lengths of its own, and `gradus solve` in the scene's.
TEST(GuideImages, TheUnitOfDepthsChangesNoBit) {
    const Wall wall(48, 32);
    const GuideHalves halves = noisy(wall.truth, 0.2, 5), expected = filtered(halves, wall.features);
    for (const int exponent : {-60, -13, 1, 50}) {
        GuideImage features = wall.features;
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 48; ++x)
                features.at(6, x, y) = std::ldexp(features.at(6, x, y), exponent);
        const GuideHalves guides = filtered(halves, features);
        EXPECT_EQ(guides[0].values, expected[0].values) << exponent;
        EXPECT_EQ(guides[1].values, expected[1].values) << exponent;
    }
}

TEST(GuideImages, WithoutNoiseNothingChanges) {
    Wall wall(40, 30);
    const GuideHalves halves{wall.truth, wall.truth};
    const GuideHalves guides = filtered(halves, wall.features);
    EXPECT_EQ(largest_difference(judged(halves, guides), wall.truth), 0);
}

TEST(GuideImages, BlackImagesStayBlack) {
    const Wall wall(20, 10);
    const GuideHalves black{GuideImage(20, 10), GuideImage(20, 10)};
    const GuideHalves guides = filtered(black, wall.features);
    EXPECT_EQ(largest_difference(judged(black, guides), black[0]), 0);
}

TEST(GuideImages, EqualRunsGiveEqualBits) {
    const Wall wall(100, 50);
    const GuideHalves halves = noisy(wall.truth, 0.2, 5);
    const GuideHalves one = filtered(halves, wall.features), two = filtered(halves, wall.features);
    EXPECT_EQ(one[0].values, two[0].values);
    EXPECT_EQ(judged(halves, one).values, judged(halves, two).values);
}

/// Noise that is independent from pixel to pixel, on a smooth wall: the window holds some eighty pixels, and what is
/// left is a share of the noise, and of it what patches that look alike by chance keep.
TEST(GuideImages, AFilteredImageIsFollowedWhereItIsRight) {
    const Wall wall(96, 64);
    const GuideHalves halves = noisy(wall.truth, 0.3, 6);
    const double before = squared_error(mean_of(halves), wall.truth);
    EXPECT_LT(squared_error(judged(halves, filtered(halves, wall.features)), wall.truth), 0.15 * before);
}

/// As samples grow the error falls as that of the image without a guide, whose share fades.
TEST(GuideImages, AGuideThatIsWrongEverywhereFades) {
    const Wall wall(96, 64);
    double worst = 0, last = 0, last_unguided = 0;
    for (const int samples : {1, 4, 16, 64, 256, 1024, 4096}) {
        const GuideHalves halves = noisy(wall.truth, 1 / std::sqrt(double(samples)), 7 + samples);
        GuideHalves guides{wall.truth, wall.truth};
        for (GuideImage &guide : guides)
            for (float &value : guide.values)
                value = 1.3f * value + 0.05f;
        const double error = squared_error(judged(halves, guides), wall.truth);
        const double unguided = squared_error(mean_of(halves), wall.truth);
        worst = worse(worst, error / unguided);
        // A guide of bias B lessens the variance V to V B^2 / (V + B^2), at most by what V is of B^2.
        if (samples == 4096) {
            EXPECT_GT(error / unguided, 0.98);
            EXPECT_NEAR(last / error, 4, 0.4);
        }
        last = error;
        last_unguided = unguided;
    }
    EXPECT_GT(last_unguided, 0);
    record_stability({"Reconstruction", "a guide image that is wrong biases what follows it",
                      "a guide a third too bright everywhere, 1 to 4096 samples",
                      "its measured error takes its weight, and the error goes on falling as 1 over the samples",
                      "largest squared error over that without a guide", worst, 1.03});
}

/// A shadow's edge that no feature shows, and noise so small that it is seen.
TEST(GuideImages, EdgesThatFeaturesDoNotShowStay) {
    Wall wall(96, 64);
    for (int c = 0; c < 3; ++c)
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 96; ++x) {
                wall.truth.at(c, x, y) = x + y < 80 ? 1.0f : 0.4f;
                for (int f = 0; f < 7; ++f)
                    wall.features.at(f, x, y) = 0.5f;
            }
    const GuideHalves halves = noisy(wall.truth, 0.1, 8);
    const GuideImage image = judged(halves, filtered(halves, wall.features)), unguided = mean_of(halves);
    double error = 0, error_unguided = 0; // of the pixels beside the edge
    for (int y = 0; y < 64; ++y)
        for (int x = std::max(0, 78 - y); x < std::min(96, 82 - y); ++x)
            for (int c = 0; c < 3; ++c) {
                error += std::pow(double(image.at(c, x, y)) - wall.truth.at(c, x, y), 2);
                error_unguided += std::pow(double(unguided.at(c, x, y)) - wall.truth.at(c, x, y), 2);
            }
    record_stability({"Reconstruction", "features that mislead: a filter that trusts them blurs what they do not show",
                      "a shadow's edge on a plain wall, noise of a tenth",
                      "patches of pixels are compared too, and what is blurred is not followed",
                      "squared error beside the edge over that without a guide", error / error_unguided, 1});
}

/// An edge of albedo seen in a mirror: features have it where the image has none.
TEST(GuideImages, EdgesThatOnlyFeaturesHaveDoNoHarm) {
    Wall wall(96, 64);
    for (float &value : wall.truth.values)
        value = 0.7f;
    const GuideHalves halves = noisy(wall.truth, 0.3, 9);
    const GuideHalves guides = filtered(halves, wall.features);
    record_stability(
        {"Reconstruction", "features that mislead: edges that the image has not, as of what a mirror shows",
         "a plain wall with edges of albedo, normal and depth, noise of 0.3",
         "to each side of them a guide of what is there", "squared error over that without a guide",
         squared_error(judged(halves, guides), wall.truth) / squared_error(mean_of(halves), wall.truth), 0.15});
}

/// Half of the light of a square comes by one sample in 64: of four samples all have missed it in 94 of 100 pixels, in
/// both halves alike, which agree on what is too dark. The light is that of the pixels that caught it: over the square
/// none may be lost, whoever follows whom.
TEST(GuideImages, LightThatBothHalvesMissedIsKept) {
    constexpr int square = 32, from = 24, samples = 2; // of a half
    double kept = 0, caught = 0;
    for (unsigned seed = 0; seed < 8; ++seed) {
        Wall wall(96, 80);
        for (float &value : wall.truth.values)
            value = 0.5f;
        for (float &value : wall.features.values)
            value = 0.5f;
        GuideHalves halves = noisy(wall.truth, 0.05, 20 + seed);
        std::mt19937 random(seed);
        std::bernoulli_distribution finds(1.0 / 64);
        for (GuideImage &half : halves)
            for (int y = from; y < from + square; ++y)
                for (int x = from; x < from + square; ++x) {
                    float more = 0;
                    for (int sample = 0; sample < samples; ++sample)
                        more += finds(random) ? 0.5f * 64 / samples : 0;
                    for (int c = 0; c < 3; ++c)
                        half.at(c, x, y) += more;
                }
        const GuideImage image = corrected(halves, judged(halves, filtered(halves, wall.features)));
        const GuideImage unguided = mean_of(halves);
        // With what the correction takes from around the square or gives there, 2 (1 + 2 + 4 + 8) pixels on.
        for (int c = 0; c < 3; ++c)
            for (int y = 0; y < 80; ++y)
                for (int x = 0; x < 96; ++x) {
                    kept += double(image.at(c, x, y)) - 0.5;
                    caught += double(unguided.at(c, x, y)) - 0.5;
                }
    }
    std::printf("of the light that few samples found %.3f is kept\n", kept / caught);
    record_stability({"Reconstruction", "halves that both missed the same light agree that there is none",
                      "half of a square's light by one sample in 64, 2 samples a half, 8 seeds",
                      "what following the guide loses its neighbourhood gives back, up to 0.3 of a pixel; some is lost",
                      "share of that light that is lost or added", std::fabs(kept / caught - 1), 0.3});
}

TEST(GuideDenoiser, SaysWhatToInstallWhereThereIsNone) {
    try {
        Denoiser denoiser("/nowhere/libOpenImageDenoise.so.2");
        FAIL() << "loaded";
    } catch (const Error &error) {
        EXPECT_EQ(error.code, ExitCode::usage);
        EXPECT_THAT(error.what(), ::testing::AllOf(::testing::HasSubstr("Open Image Denoise"),
                                                   ::testing::HasSubstr("GRADUS_DENOISER")));
    }
}

/// A library of ours with the same interface (stub_denoiser.cpp): it gives the color times the albedo's red and adds
/// the normal's z, each as given to it, where the filter of albedo and normal doubles them.
TEST(GuideDenoiser, HandsImagesOverAndBack) {
    Denoiser denoiser(GRADUS_STUB_DENOISER, 1);
    EXPECT_EQ(denoiser.version(), "2.5.1");
    GuideImage color(3, 2), albedo(3, 2), normal(3, 2), result(3, 2);
    for (int i = 0; i < 18; ++i) {
        color.values[i] = float(i);
        albedo.values[i] = 0.1f * float(i);
        normal.values[i] = 0.01f * float(i);
    }
    color.values[4] = missing_value;
    const Denoiser::Features features = denoiser.cleaned(albedo.values.data(), normal.values.data(), 3, 2);
    denoiser.run(color.values.data(), features, 3, 2, result.values.data());
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 6; ++i) {
            const float given = c == 0 && i == 4 ? 0 : color.values[6 * c + i];
            EXPECT_FLOAT_EQ(result.values[6 * c + i], given * (2 * albedo.values[i]) + 2 * normal.values[12 + i]);
        }
    denoiser.run(color.values.data(), {}, 3, 2, result.values.data());
    EXPECT_FLOAT_EQ(result.values[5], 5);
}

} // namespace
} // namespace gradus::testing
