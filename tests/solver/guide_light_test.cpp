// What gives a guided image back the light that its guide has lost.
#include "solver/guide/light_correction.h"
#include "tests/solver/guide_reference.h"
#include "tests/solver/solver_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gradus::testing {
namespace {

/// Gray waves between 0.1 and 2, the same in both halves.
GuideImage waves(int width, int height) {
    GuideImage image(width, height);
    for (int c = 0; c < 3; ++c)
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                image.at(c, x, y) = 0.1f + 1.9f * std::abs(std::sin(0.3f * float(x) + 0.2f * float(y)));
    return image;
}

GuideImage corrected(const GuideImage &halves_mean, const GuideImage &image) {
    const auto buffer = [](const char *name, const GuideImage &from) {
        return Buffer(test_device(), name, from.values.data(), from.values.size() * sizeof(float));
    };
    const Buffer half = buffer("half", halves_mean);
    Buffer written = buffer("image", image);
    LightCorrection(test_device(), std::uint32_t(image.width), std::uint32_t(image.height))
        .run({&half, &half}, 0.5, written);
    GuideImage result = image;
    written.read(result.values.data(), written.bytes());
    return result;
}

GuideImage scaled(GuideImage image, float factor) {
    for (float &value : image.values)
        value *= factor;
    return image;
}

/// A tenth is missing everywhere, so that every neighbourhood tells the same share, whatever its weights. A mean of up
/// to 3^8 terms rounds to some 1e-6.
TEST(LightCorrection, GivesBackWhatIsMissing) {
    for (const auto &[width, height] : {std::pair{70, 50}, {1, 1}, {40, 1}, {1, 40}, {17, 9}}) {
        const GuideImage truth = waves(width, height), found = corrected(truth, scaled(truth, 0.9f));
        for (std::size_t i = 0; i < truth.values.size(); ++i)
            ASSERT_NEAR(found.values[i] / truth.values[i], 1, 1e-5) << width << "x" << height << " " << i;
    }
}

TEST(LightCorrection, TakesWhatIsTooMuch) {
    const GuideImage truth = waves(40, 30), found = corrected(truth, scaled(truth, 1.25f));
    for (std::size_t i = 0; i < truth.values.size(); ++i)
        ASSERT_NEAR(found.values[i] / truth.values[i], 1, 1e-5);
}

TEST(LightCorrection, WithoutALossNothingChanges) {
    const GuideImage truth = waves(40, 30);
    EXPECT_EQ(corrected(truth, truth).values, truth.values);
    const GuideImage black(20, 20);
    EXPECT_EQ(corrected(black, black).values, black.values);
}

/// A highlight that has lost a fifth beside a wall a hundred times darker: ln 100 / 0.3 is 15 standard deviations.
TEST(LightCorrection, DoesNotLeakAcrossEdges) {
    GuideImage truth(48, 32);
    for (int c = 0; c < 3; ++c)
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 48; ++x)
                truth.at(c, x, y) = x < 24 ? 10.0f : 0.1f;
    GuideImage image = truth;
    for (int c = 0; c < 3; ++c)
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 24; ++x)
                image.at(c, x, y) = 8.0f;
    const GuideImage found = corrected(truth, image);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 48; ++x)
            ASSERT_NEAR(found.at(1, x, y) / truth.at(1, x, y), 1, 1e-5) << x << " " << y;
}

/// A firefly of the halves that the image has not: none of its neighbours becomes a third brighter. What is not finite
/// gives nothing.
TEST(LightCorrection, KeepsFirefliesAndHolesOut) {
    GuideImage halves = waves(40, 30), image = halves;
    halves.at(0, 20, 15) = 1e6f;
    for (const float value : corrected(halves, image).values)
        ASSERT_LE(value, 2.0f * 1.3001f);
    const float none = std::numeric_limits<float>::quiet_NaN();
    halves = image;
    halves.at(2, 5, 5) = none;
    image.at(1, 30, 20) = none;
    const GuideImage found = corrected(halves, image);
    for (std::size_t i = 0; i < found.values.size(); ++i) {
        if (std::isfinite(image.values[i])) {
            ASSERT_EQ(found.values[i], image.values[i]) << i;
        }
    }
}

} // namespace
} // namespace gradus::testing
