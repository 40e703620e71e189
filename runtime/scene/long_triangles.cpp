#include "runtime/scene/long_triangles.h"

#include "kernels/lib/scene_triangle.h"
#include "runtime/scene/mesh_builder.h"
#include "runtime/scene/vertex_table.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace gradus {

using namespace lib_float;

namespace {

using Range = tbb::blocked_range<std::size_t>;
constexpr std::size_t grain = 1 << 14;

/// Of a surface's triangles, their length over their width: a ray in 10^4.8 is lost there.
constexpr double most_length_over_width = 256;

struct Edges {
    std::array<double, 3> square; ///< of the length of the edge opposite to each corner
    double doubled_area;

    Edges(const Mesh &mesh, const std::array<std::uint32_t, 3> &triangle) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Vector3 &a = mesh.positions[triangle[(corner + 1) % 3]],
                          &b = mesh.positions[triangle[(corner + 2) % 3]];
            const double x = double(b.x) - a.x, y = double(b.y) - a.y, z = double(b.z) - a.z;
            square[corner] = x * x + y * y + z * z;
        }
        const Double3 normal = area_vector(mesh, triangle);
        doubled_area = std::sqrt(dot(normal, normal));
    }
    /// How much larger the product of the edges from the first corner is than the area that they span.
    bool slants_at_first() const {
        constexpr double most = GRADUS_LEAST_SLANT;
        return square[1] * square[2] > most * most * doubled_area * doubled_area;
    }
};

} // namespace

void begin_at_widest_corners(Scene &scene) {
    std::vector<bool> stays(scene.meshes.size());
    for (const Shape &shape : scene.shapes)
        if (shape.kind == Shape::Kind::mesh && has_own_vertices(scene, shape))
            stays[shape.geometry] = true;
    for (std::size_t number = 0; number < scene.meshes.size(); ++number) {
        Mesh &mesh = scene.meshes[number];
        if (stays[number])
            continue;
        tbb::parallel_for(Range(0, mesh.triangles.size(), grain), [&](const Range &range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                auto &triangle = mesh.triangles[i];
                const Edges edges(mesh, triangle);
                if (!edges.slants_at_first())
                    continue;
                const auto widest = std::max_element(edges.square.begin(), edges.square.end());
                std::rotate(triangle.begin(), triangle.begin() + (widest - edges.square.begin()), triangle.end());
            }
        });
    }
}

bool has_long_triangles(const Scene &scene) {
    struct Sums {
        double square = 0, doubled_area = 0;
        Sums operator+(const Sums &other) const { return {square + other.square, doubled_area + other.doubled_area}; }
    };
    return std::ranges::any_of(scene.meshes, [](const Mesh &mesh) {
        const Sums sums = tbb::parallel_deterministic_reduce(
            Range(0, mesh.triangles.size(), grain), Sums(),
            [&](const Range &range, Sums sum) {
                for (std::size_t i = range.begin(); i < range.end(); ++i) {
                    const Edges edges(mesh, mesh.triangles[i]);
                    sum = sum + Sums{std::ranges::max(edges.square), edges.doubled_area};
                }
                return sum;
            },
            [](const Sums &a, const Sums &b) { return a + b; });
        return sums.square > most_length_over_width * sums.doubled_area;
    });
}

} // namespace gradus
