#include "runtime/film/metrics.h"

#include "runtime/error.h"
#include "runtime/film/outliers.h"
#include "tests/film/make_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace gradus {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

TEST(Metrics, RelativeMseOfHandComputedValues) {
    const Image reference = make_image(2, 1, {{"R", {1, 2}}, {"G", {0, 4}}, {"B", {3, 0.5f}}});
    const Image image = make_image(2, 1, {{"R", {1.5f, 2}}, {"G", {0.1f, 3}}, {"B", {3, 0.5f}}});
    const double expected = (0.25 / 1.001 + double(0.1f) * 0.1f / 0.001 + 1.0 / 16.001) / 6;
    EXPECT_NEAR(relative_mse(image, reference), expected, 1e-12);
    EXPECT_EQ(relative_mse(reference, reference), 0);
}

TEST(Metrics, ChannelsAreFoundByNameWhateverTheirOrder) {
    const Image reference = make_image(1, 1, {{"R", {1}}, {"G", {2}}, {"B", {3}}});
    const Image shuffled = make_image(1, 1, {{"B", {3}}, {"depth.Z", {100}}, {"R", {1}}, {"G", {2}}});
    EXPECT_EQ(relative_mse(shuffled, reference), 0);
    EXPECT_EQ(relative_mse(reference, shuffled), 0);
}

TEST(Metrics, ReferencesWithoutColorAreComparedOverAllTheirChannels) {
    const Image reference = make_image(1, 1, {{"X", {1}}, {"Y", {0}}});
    const Image image = make_image(1, 1, {{"Y", {0}}, {"X", {2}}, {"Z", {7}}});
    EXPECT_NEAR(relative_mse(image, reference), 1 / 1.001 / 2, 1e-12);
}

TEST(Metrics, TrimmedLeavesOutTheWorstThousandth) {
    std::vector<float> ones(2000, 1.0f), noisy(2000, 1.1f);
    noisy[3] = 1e6f;
    noisy[700] = 500;
    const Image reference = make_gray(50, 40, ones), image = make_gray(50, 40, noisy);
    const double usual = double(1.1f - 1.0) * double(1.1f - 1.0) / 1.001;
    EXPECT_NEAR(trimmed_relative_mse(image, reference), usual, 1e-7);
    EXPECT_GT(relative_mse(image, reference), 1e8);
    // A third bright pixel is one too many.
    noisy[900] = 500;
    EXPECT_GT(trimmed_relative_mse(make_gray(50, 40, noisy), reference), 100);
    // Fewer than a thousand pixels: none is left out.
    EXPECT_EQ(trimmed_relative_mse(make_gray(2, 1, {1, 5}), make_gray(2, 1, {1, 1})),
              relative_mse(make_gray(2, 1, {1, 5}), make_gray(2, 1, {1, 1})));
}

TEST(Metrics, RelativeVarianceOfHandComputedValues) {
    const Image reference = make_image(2, 1, {{"R", {1, 2}}, {"G", {0, 4}}, {"B", {3, 0.5f}}});
    const Image variance = make_image(2, 1, {{"R", {0.5f, 0}}, {"G", {0.25f, 1}}, {"B", {0, 0.125f}}});
    const double expected = (0.5 / 1.001 + 0.25 / 0.001 + 1 / 16.001 + 0.125 / 0.251) / 6;
    EXPECT_NEAR(relative_variance(variance, reference), expected, 1e-12);
}

TEST(Metrics, PeakIsThePercentileOfTheReference) {
    std::vector<float> values(1000);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = float((i * 7) % 1000); // 0 to 999 in another order
    EXPECT_EQ(reference_peak(make_image(100, 10, {{"Y", values}})), 998);
    EXPECT_EQ(reference_peak(make_image(1, 1, {{"Y", {5}}})), 5);
}

TEST(Metrics, PsnrOfHandComputedValues) {
    // Peak 2, squared errors 0.01 everywhere: 10 log10(4 / 0.01).
    const Image reference = make_gray(2, 1, {2, 1}), image = make_gray(2, 1, {2.1f, 0.9f});
    EXPECT_NEAR(psnr(image, reference), 10 * std::log10(400.0), 1e-5);
    EXPECT_EQ(psnr(reference, reference), std::numeric_limits<double>::infinity());
}

TEST(Metrics, MeansRatioAndBias) {
    const MeanComparison means = compare_means(make_gray(2, 1, {1, 2}), make_gray(2, 1, {1, 1}));
    EXPECT_DOUBLE_EQ(means.image, 1.5);
    EXPECT_DOUBLE_EQ(means.reference, 1);
    EXPECT_DOUBLE_EQ(means.ratio, 1.5);
    EXPECT_DOUBLE_EQ(means.bias, 0.5);
}

TEST(Metrics, NonFinitePixelsAreCountedAndLeftOut) {
    const Image reference = make_gray(3, 1, {1, 1, 1});
    const Image image =
        make_image(3, 1, {{"R", {1.5f, not_a_number, 1.5f}}, {"G", {1.5f, 1, 1.5f}}, {"B", {1.5f, infinity, 1.5f}}});
    EXPECT_EQ(count_non_finite(image), 2u);
    EXPECT_EQ(count_non_finite(reference), 0u);
    EXPECT_NEAR(relative_mse(image, reference), 0.25 / 1.001, 1e-12);
    EXPECT_NEAR(compare_means(image, reference).ratio, 1.5, 1e-12);
    EXPECT_NEAR(psnr(image, reference), 10 * std::log10(1 / 0.25), 1e-9);
    EXPECT_TRUE(std::isnan(relative_mse(make_gray(1, 1, {infinity}), make_gray(1, 1, {1}))));
}

TEST(Metrics, ImagesThatDoNotFitAreErrors) {
    const Image reference = make_gray(2, 1, {1, 1});
    const auto code_of = [&](const Image &image) {
        try {
            relative_mse(image, reference);
        } catch (const Error &error) {
            return error.code;
        }
        return ExitCode::success;
    };
    EXPECT_EQ(code_of(make_gray(1, 2, {1, 1})), ExitCode::image);
    EXPECT_EQ(code_of(make_image(2, 1, {{"R", {1, 1}}, {"G", {1, 1}}})), ExitCode::image);
    EXPECT_EQ(code_of(make_gray(2, 1, {1})), ExitCode::image);
    EXPECT_EQ(code_of(reference), ExitCode::success);
    EXPECT_THROW(relative_mse(Image(), Image()), Error);
}

TEST(Metrics, RelativeErrorImageSquaresToRelativeMse) {
    const Image reference = make_image(2, 1, {{"R", {1, 2}}, {"G", {0, 4}}, {"B", {3, 0.5f}}});
    const Image image = make_image(2, 1, {{"R", {1.5f, 1}}, {"G", {0.1f, 3}}, {"B", {9, 0.5f}}});
    const Image error = relative_error_image(image, reference);
    double sum = 0;
    for (const Channel &channel : error.channels)
        for (const float value : channel.values)
            sum += double(value) * value;
    EXPECT_NEAR(sum / 6, relative_mse(image, reference), 1e-6);
    EXPECT_GT(error.find("R")->values[0], 0);
    EXPECT_LT(error.find("R")->values[1], 0);
}

TEST(Metrics, ErrorPictureIsRedWhereTooBrightAndBlueWhereTooDark) {
    const Image picture = error_picture(make_gray(5, 1, {0, 0.25f, -0.25f, 50, not_a_number}));
    const auto at = [&](int pixel) {
        return std::vector<float>{picture.find("R")->values[pixel], picture.find("G")->values[pixel],
                                  picture.find("B")->values[pixel]};
    };
    using ::testing::ElementsAre;
    EXPECT_THAT(at(0), ElementsAre(1, 1, 1));
    EXPECT_THAT(at(1), ElementsAre(1, 0.75f, 0.75f));
    EXPECT_THAT(at(2), ElementsAre(0.75f, 0.75f, 1));
    EXPECT_THAT(at(3), ElementsAre(1, 0, 0));
    EXPECT_THAT(at(4), ElementsAre(1, 1, 0));
}

/// Wherever it is, and in images in which all pixels are at an edge.
TEST(Outliers, OfOnePixelAreNotTheirOwnReference) {
    for (const auto &[width, height] : {std::pair{5u, 4u}, {1u, 6u}, {6u, 1u}, {2u, 2u}, {1u, 2u}})
        for (std::size_t at = 0; at < std::size_t(width) * height; ++at)
            for (const double outlier : {1000.0, -1000.0}) {
                std::vector<double> plane(std::size_t(width) * height, 2);
                plane[at] = outlier;
                EXPECT_EQ(without_outliers(plane, width, height)[at], 2) << width << " x " << height << ", " << at;
            }
    EXPECT_EQ(without_outliers({7}, 1, 1), std::vector<double>{7}) << "nothing is around it";
}

TEST(Outliers, AreHeldToTheSecondOfThoseAround) {
    EXPECT_EQ(without_outliers({1, 2, 3, 4, 90, 5, 6, 7, 8}, 3, 3)[4], 7);
    EXPECT_EQ(without_outliers({1, 2, 3, 4, -90, 5, 6, 7, 8}, 3, 3)[4], 2);
    EXPECT_EQ(without_outliers({1, 2, 3, 4, 4.5, 5, 6, 7, 8}, 3, 3)[4], 4.5);
}

TEST(Metrics, MeanImage) {
    const Image mean = mean_image({make_gray(2, 1, {1, 4}), make_gray(2, 1, {3, 6})});
    EXPECT_THAT(mean.find("G")->values, ::testing::ElementsAre(2, 5));
}

TEST(Metrics, LayersAreSelectedByName) {
    const Image image = make_image(1, 1, {{"R", {1}}, {"albedo.R", {2}}, {"albedo.G", {3}}, {"a.b.Z", {4}}});
    const Image albedo = select_layer(image, "albedo");
    ASSERT_EQ(albedo.channels.size(), 2u);
    EXPECT_EQ(albedo.find("R")->values[0], 2);
    EXPECT_EQ(select_layer(image, "a.b").find("Z")->values[0], 4);
    try {
        select_layer(image, "normal");
        FAIL() << "a layer that is not there was found";
    } catch (const Error &error) {
        EXPECT_THAT(error.what(), ::testing::HasSubstr("a.b, albedo"));
    }
}

} // namespace
} // namespace gradus
