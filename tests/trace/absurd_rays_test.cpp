// Rays of numbers that Embree does not take, as an absurd camera makes them: they meet nothing, and those beside them
// what they always meet.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

#include "runtime/trace/embree.h"
#include "runtime/trace/tracer.h"

#include "kernels/shared/tables.h"

namespace gradus::testing {
namespace {

TEST(AbsurdRays, MeetNothingAndHarmNone) {
    Scene scene;
    scene.materials.resize(1);
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}};
    mesh.triangles = {{0, 1, 2}};
    scene.meshes.push_back(mesh);
    scene.shapes.emplace_back();
    Tracer tracer(scene, 1);

    const float infinite = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<std::array<float, 6>> rays;
    for (const float absurd : {infinite, -infinite, nan, 2e18f, -1e30f})
        for (std::size_t column = 0; column < 6; ++column) {
            rays.push_back({0, 0, 1, 0, 0, -2});
            rays.push_back(rays.back());
            rays.back()[column] = absurd;
        }
    std::array<std::vector<float>, 6> columns;
    for (const std::array<float, 6> &ray : rays)
        for (std::size_t column = 0; column < 6; ++column)
            columns[column].push_back(ray[column]);
    std::vector<std::uint32_t> primitive(rays.size(), ray_pending), open(rays.size(), 1);
    RayColumns ray{};
    ShadowColumns shadow{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        ray.origin[axis] = shadow.origin[axis] = columns[axis].data();
        ray.direction[axis] = shadow.direction[axis] = columns[3 + axis].data();
    }
    ray.primitive = primitive.data();
    shadow.open = open.data();
    tracer.trace(ray, rays.size(), shadow, rays.size());
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
