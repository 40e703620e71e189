#include "runtime/trace/flush_denormals.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <limits>
#include <thread>

namespace gradus {
namespace {

TEST(FlushDenormals, MakesThemZeroFromThenOn) {
    const auto product = [](float a, float b) {
        const volatile float first = a, second = b; // not at compile time
        return first * second;
    };
    constexpr float least = std::numeric_limits<float>::min(), denormal = std::numeric_limits<float>::denorm_min();
    // Threads begin as the one that starts them is, which may have traced.
    const auto as_usual = [] { std::fesetenv(FE_DFL_ENV); };
    std::thread([&] {
        as_usual();
        const float result_before = product(least, 0.5f), input_before = product(denormal, 0x1p60f);
        flush_denormals();
        const float result_after = product(least, 0.5f), input_after = product(denormal, 0x1p60f);
        as_usual(); // or comparisons would not know them
        EXPECT_GT(result_before, 0.0f);
        EXPECT_GT(input_before, 0.0f);
        EXPECT_EQ(result_after, 0.0f);
        EXPECT_EQ(input_after, 0.0f);
    }).join();
}

} // namespace
} // namespace gradus
