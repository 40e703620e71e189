// Rays that meet the edge between two triangles: both are as near, and which one is found does not depend on the rays
// that are traced beside them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "runtime/trace/tracer.h"

#include "kernels/shared/tables.h"

namespace gradus::testing {
namespace {

constexpr std::size_t edge_rays = 1 << 18;

/// An uneven floor of n x n squares, each of two triangles.
Scene floor_of(std::uint32_t n) {
    std::mt19937 bits(n);
    std::uniform_real_distribution<float> height(0, 0.3f / float(n));
    Mesh mesh;
    for (std::uint32_t y = 0; y <= n; ++y)
        for (std::uint32_t x = 0; x <= n; ++x)
            mesh.positions.push_back({float(x) / float(n), height(bits), float(y) / float(n)});
    for (std::uint32_t y = 0; y < n; ++y)
        for (std::uint32_t x = 0; x < n; ++x) {
            const std::uint32_t at = y * (n + 1) + x;
            mesh.triangles.push_back({at, at + n + 1, at + 1});
            mesh.triangles.push_back({at + 1, at + n + 1, at + n + 2});
        }
    Scene scene;
    scene.materials.resize(1);
    scene.meshes.push_back(mesh);
    scene.shapes.emplace_back();
    return scene;
}

using Columns = std::array<std::vector<float>, 6>; ///< origin and direction

/// From above to places on diagonals of squares.
Columns to_edges(const Mesh &mesh) {
    std::mt19937 bits(1);
    std::uniform_real_distribution<float> uniform(0, 1);
    Columns columns;
    for (std::size_t i = 0; i < edge_rays; ++i) {
        const auto &triangle = mesh.triangles[std::size_t(uniform(bits) * float(mesh.triangles.size() / 2)) * 2];
        const Vector3 a = mesh.positions[triangle[1]], b = mesh.positions[triangle[2]];
        const float share = uniform(bits);
        const float to[3] = {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.z + share * (b.z - a.z)};
        const float from[3] = {uniform(bits), 0.4f + uniform(bits), uniform(bits)};
        const float length = std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
        for (std::size_t k = 0; k < 3; ++k) {
            columns[k].push_back(from[k]);
            columns[3 + k].push_back((to[k] - from[k]) / length);
        }
    }
    return columns;
}

/// What each ray meets where they are traced in that order.
std::vector<std::uint32_t> met(Tracer &tracer, const Columns &columns, const std::vector<std::uint32_t> &order) {
    Columns ordered;
    for (std::size_t k = 0; k < 6; ++k)
        for (const std::uint32_t i : order)
            ordered[k].push_back(columns[k][i]);
    std::vector<std::uint32_t> primitives(edge_rays, ray_pending), by_ray(edge_rays);
    RayColumns ray{};
    for (std::size_t k = 0; k < 3; ++k) {
        ray.origin[k] = ordered[k].data();
        ray.direction[k] = ordered[3 + k].data();
    }
    ray.primitive = primitives.data();
    tracer.trace(ray, edge_rays, {}, 0);
    for (std::size_t i = 0; i < edge_rays; ++i)
        by_ray[order[i]] = primitives[i];
    return by_ray;
}

// Of few triangles, packets are beams; of more they are not.
TEST(Edges, AreMetOnTheSameSideInAnyPacket) {
    for (const std::uint32_t n : {3u, 8u, 30u}) {
        const Scene scene = floor_of(n);
        Tracer tracer(scene, 0);
        const Columns columns = to_edges(scene.meshes[0]);
        std::vector<std::uint32_t> order(edge_rays);
        std::iota(order.begin(), order.end(), 0u);
        const std::vector<std::uint32_t> first = met(tracer, columns, order);
        std::shuffle(order.begin(), order.end(), std::mt19937(2));
        const std::vector<std::uint32_t> second = met(tracer, columns, order);
        std::size_t different = 0, even = 0, missed = 0;
        for (std::size_t i = 0; i < edge_rays; ++i) {
            different += first[i] != second[i];
            even += first[i] % 2 == 0;
            missed += first[i] == ray_escaped;
        }
        std::printf("  %u x %u: %zu of %zu differ; %.2f on one side, %zu missed\n", n, n, different, edge_rays,
                    double(even) / double(edge_rays), missed);
        EXPECT_EQ(different, 0u);
        EXPECT_GT(even, edge_rays / 20) << "rays are not near the edges";
        EXPECT_LT(even, edge_rays - edge_rays / 20) << "rays are not near the edges";
    }
}

} // namespace
} // namespace gradus::testing
