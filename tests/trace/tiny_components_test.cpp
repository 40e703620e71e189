// Rays along an axis, whose other components are next to nothing or nothing, of either sign, as normals of surfaces
// that were turned have them: they meet what is in their way, whatever is traced beside them.
#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

#include "tests/trace/traced_rays.h"

namespace gradus::testing {
namespace {

constexpr std::size_t axis_rays = 1 << 16;

/// Squares at 0 of the axis, each of two triangles, in a row along the next axis.
Scene squares(int axis, std::uint32_t count) {
    const std::size_t up = std::size_t(axis), along = (up + 1) % 3, across = (up + 2) % 3;
    Mesh mesh;
    for (std::uint32_t square = 0; square < count; ++square) {
        const auto first = std::uint32_t(mesh.positions.size());
        for (std::uint32_t corner = 0; corner < 4; ++corner) {
            std::array<float, 3> at{};
            at[along] = float(square) + float(corner & 1);
            at[across] = float(corner >> 1) - 0.5f;
            mesh.positions.push_back({at[0], at[1], at[2]});
        }
        mesh.triangles.push_back({first, first + 1, first + 3});
        mesh.triangles.push_back({first, first + 3, first + 2});
    }
    return scene_of(std::move(mesh));
}

// Packets are beams where a scene has few primitives. A beam has a side for each axis by which its rays come, and
// Embree takes components below 1e-18 for that, whatever their sign: beside rays of the other sign, all were lost.
TEST(TinyComponents, LoseNoRay) {
    for (const std::uint32_t count : {100u, 400u})
        for (int axis = 0; axis < 3; ++axis) {
            Tracer tracer(squares(axis, count), 0);
            const std::size_t up = std::size_t(axis), along = (up + 1) % 3, across = (up + 2) % 3;
            std::mt19937 bits(1);
            std::uniform_real_distribution<float> uniform(0, 1);
            constexpr std::array<float, 6> sizes = {0, 1e-36f, 1e-24f, 3e-18f, 1e-10f, 0.1f};
            Columns columns;
            for (std::size_t i = 0; i < axis_rays; ++i) {
                const bool from_above = i % 2 == 0;
                std::array<float, 6> ray{};
                ray[along] = 1 + (float(count) - 2) * uniform(bits);
                ray[across] = 0.6f * uniform(bits) - 0.3f;
                ray[up] = from_above ? 0.5f : -0.5f;
                ray[3 + up] = from_above ? -1.0f : 1.0f;
                for (const std::size_t side : {along, across})
                    ray[3 + side] = (bits() % 2 == 0 ? 1.0f : -1.0f) * sizes[bits() % sizes.size()];
                append(columns, ray);
            }
            const auto [primitives, open] = traced(tracer, columns);
            std::size_t missed = 0, passed = 0;
            for (std::size_t i = 0; i < axis_rays; ++i) {
                missed += primitives[i] >= ray_first_special;
                passed += open[i] != 0;
            }
            // A ray in some millions goes through an edge (edges_test.cpp).
            EXPECT_LE(missed, 1u) << count << " squares, axis " << axis;
            EXPECT_LE(passed, 1u) << count << " squares, axis " << axis;
        }
}

} // namespace
} // namespace gradus::testing
