// Rays of numbers that Embree does not take, as an absurd camera makes them: they meet nothing, and those beside them
// what they always meet.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

#include "runtime/trace/embree.h"

#include "tests/trace/traced_rays.h"

namespace gradus::testing {
namespace {

TEST(AbsurdRays, MeetNothingAndHarmNone) {
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}};
    mesh.triangles = {{0, 1, 2}};
    Tracer tracer(scene_of(mesh), 1);

    const float infinite = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<std::array<float, 6>> rays;
    for (const float absurd : {infinite, -infinite, nan, 2e18f, -1e30f})
        for (std::size_t column = 0; column < 6; ++column) {
            rays.push_back({0, 0, 1, 0, 0, -2});
            rays.push_back(rays.back());
            rays.back()[column] = absurd;
        }
    Columns columns;
    for (const std::array<float, 6> &ray : rays)
        append(columns, ray);
    const auto [primitive, open] = traced(tracer, columns);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        EXPECT_EQ(primitive[i], i % 2 == 0 ? 0u : ray_escaped) << i;
        EXPECT_EQ(open[i], 0u) << i;
    }
}

/// As AbsurdRays needs it on processors without AVX-512.
TEST(InvalidRays, EndBeforeTheyBegin) {
    RTCRay16 packet{};
    int valid[16];
    for (int lane = 0; lane < 16; ++lane) {
        packet.tfar[lane] = float(lane);
        valid[lane] = lane % 3 == 0 ? -1 : 0;
    }
    end_invalid_rays(valid, packet);
    for (int lane = 0; lane < 16; ++lane)
        EXPECT_EQ(packet.tfar[lane], valid[lane] ? float(lane) : -std::numeric_limits<float>::infinity()) << lane;
}

} // namespace
} // namespace gradus::testing
