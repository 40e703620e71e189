#include "runtime/film/tonemap.h"

#include "runtime/error.h"
#include "tests/film/make_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace gradus {
namespace {

TEST(Tonemap, CurveAndItsInverse) {
    EXPECT_FLOAT_EQ(srgb_encode(0), 0);
    EXPECT_NEAR(srgb_encode(1), 1, 1e-6);
    EXPECT_NEAR(srgb_encode(0.18f), 0.461356f, 1e-5); // middle grey
    EXPECT_NEAR(srgb_encode(0.001f), 0.01292f, 1e-7); // the straight part
    for (int i = 0; i <= 100; ++i)
        EXPECT_NEAR(srgb_decode(srgb_encode(float(i) / 100)), float(i) / 100, 2e-6);
}

TEST(Tonemap, EightBitValues) {
    const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    const Image image =
        make_image(3, 1, {{"B", {0, infinity, -infinity}}, {"R", {1, 0.18f, -3}}, {"G", {2, 1e6f, nan}}});
    EXPECT_THAT(tonemap(image), ::testing::ElementsAre(255, 255, 0, 118, 255, 255, 0, 0, 0));
}

TEST(Tonemap, AMissingChannelIsAnError) { EXPECT_THROW(tonemap(make_image(1, 1, {{"R", {1}}, {"G", {1}}})), Error); }

} // namespace
} // namespace gradus
