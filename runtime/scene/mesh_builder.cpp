#include "runtime/scene/mesh_builder.h"

#include "runtime/scene/parallel.h"
#include "runtime/scene/transform.h"

#include <algorithm>
#include <cmath>

namespace gradus {
namespace {

bool is_finite(const Vector3 &v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void transform_positions(Mesh &mesh, const Matrix4 &to_world) {
    for_each_in_parallel(mesh.positions.size(), [&](std::size_t i) {
        mesh.positions[i] = to_float(transform_point(to_world, to_double(mesh.positions[i])));
    });
}

/// Normals that are zero or not finite become (0, 0, 0), which settle_normals() replaces.
void transform_normals(Mesh &mesh, const Matrix4 &to_world, bool keeps_proportions) {
    const NormalMap map(to_world);
    const double common = keeps_proportions ? std::pow(std::fabs(determinant(to_world)), -2.0 / 3) : 0;
    for_each_in_parallel(mesh.normals.size(), [&](std::size_t i) {
        const Double3 mapped = map(to_double(mesh.normals[i]));
        const double size = length(mapped);
        mesh.normals[i] =
            std::isfinite(size) && size > 0 ? to_float(scale(mapped, common > 0 ? common : 1 / size)) : Vector3{};
    });
}

/// Drops triangles that have no area in single precision, where they are intersected. The threshold is relative to
/// the longest edge, so a tiny mesh loses nothing.
std::size_t drop_degenerate(Mesh &mesh) {
    const auto is_degenerate = [&](const std::array<std::uint32_t, 3> &t) {
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
            return true;
        for (std::uint32_t index : t)
            if (!is_finite(mesh.positions[index]))
                return true;
        double longest_square = 0;
        for (int i = 0; i < 3; ++i) {
            const Double3 edge = subtract(to_double(mesh.positions[t[(i + 1) % 3]]), to_double(mesh.positions[t[i]]));
            longest_square = std::max(longest_square, dot(edge, edge));
        }
        const Double3 area = area_vector(mesh, t);
        const double twice_area = std::sqrt(dot(area, area)); // of single precision: no square is out of range
        return !(twice_area > 1e-10 * longest_square) || !std::isnormal(float(twice_area));
    };
    std::vector<char> drops(mesh.triangles.size());
    for_each_in_parallel(drops.size(), [&](std::size_t i) { drops[i] = is_degenerate(mesh.triangles[i]); });
    std::size_t kept = 0;
    if (std::find(drops.begin(), drops.end(), 1) == drops.end())
        return 0;
    for (std::size_t i = 0; i < drops.size(); ++i)
        if (!drops[i])
            mesh.triangles[kept++] = mesh.triangles[i];
    mesh.triangles.resize(kept);
    for (MeshAttribute &attribute : mesh.attributes) {
        if (!is_by_face(attribute.name))
            continue;
        std::size_t to = 0;
        for (std::size_t i = 0; i < drops.size(); ++i)
            for (std::size_t c = 0; c < attribute.channels && !drops[i]; ++c)
                attribute.values[to++] = attribute.values[i * attribute.channels + c];
        attribute.values.resize(to);
    }
    return drops.size() - kept;
}

/// What no triangle uses goes to where one is: bounds that someone takes over all positions are of what can be hit.
void hide_unused(Mesh &mesh) {
    std::vector<bool> used(mesh.positions.size(), false);
    for (const auto &t : mesh.triangles)
        for (const std::uint32_t index : t)
            used[index] = true;
    const Vector3 place = mesh.triangles.empty() ? Vector3{} : mesh.positions[mesh.triangles[0][0]];
    for (std::size_t i = 0; i < used.size(); ++i)
        if (!used[i])
            mesh.positions[i] = place;
}

/// The file's normals tell the front: a triangle that is wound against the sum of its three is turned round.
void wind_along_normals(Mesh &mesh) {
    for_each_in_parallel(mesh.triangles.size(), [&](std::size_t i) {
        auto &t = mesh.triangles[i];
        const Double3 sum =
            add(add(to_double(mesh.normals[t[0]]), to_double(mesh.normals[t[1]])), to_double(mesh.normals[t[2]]));
        if (dot(area_vector(mesh, t), sum) < 0)
            std::swap(t[1], t[2]);
    });
}

/// Replaces missing normals (0, 0, 0) by computed ones.
void settle_normals(Mesh &mesh) {
    const Vector3 missing{};
    if (std::find(mesh.normals.begin(), mesh.normals.end(), missing) == mesh.normals.end())
        return;
    const std::vector<Vector3> computed = smooth_vertex_normals(mesh);
    for (std::size_t i = 0; i < mesh.normals.size(); ++i)
        if (mesh.normals[i] == missing)
            mesh.normals[i] = computed[i];
}

void reverse_winding(Mesh &mesh) {
    for (auto &t : mesh.triangles)
        std::swap(t[1], t[2]);
}

} // namespace

Double3 area_vector(const Mesh &mesh, const std::array<std::uint32_t, 3> &triangle) {
    const Double3 p0 = to_double(mesh.positions[triangle[0]]);
    return cross(subtract(to_double(mesh.positions[triangle[1]]), p0),
                 subtract(to_double(mesh.positions[triangle[2]]), p0));
}

std::vector<Vector3> smooth_vertex_normals(const Mesh &mesh) {
    std::vector<Double3> sums(mesh.positions.size(), Double3{0, 0, 0});
    // What triangles add on all cores, a block at a time, and the sums in their order, so that they are always the
    // same.
    constexpr std::size_t block = 1 << 18;
    std::vector<std::array<Double3, 3>> parts(std::min(block, mesh.triangles.size()));
    for (std::size_t begin = 0; begin < mesh.triangles.size(); begin += block) {
        const std::size_t count = std::min(block, mesh.triangles.size() - begin);
        for_each_in_parallel(count, [&](std::size_t number) {
            const auto &t = mesh.triangles[begin + number];
            const Double3 area = area_vector(mesh, t);
            const double size = length(area);
            for (int i = 0; i < 3; ++i) {
                const Double3 corner = to_double(mesh.positions[t[i]]);
                const Double3 a = subtract(to_double(mesh.positions[t[(i + 1) % 3]]), corner);
                const Double3 b = subtract(to_double(mesh.positions[t[(i + 2) % 3]]), corner);
                const double angle = std::atan2(length(cross(a, b)), dot(a, b));
                parts[number][i] = size > 0 ? scale(scale(area, 1 / size), angle) : Double3{0, 0, 0};
            }
        });
        for (std::size_t number = 0; number < count; ++number)
            for (int i = 0; i < 3; ++i) {
                const std::uint32_t vertex = mesh.triangles[begin + number][i];
                Double3 &sum = sums[mesh.normal_of.empty() ? vertex : mesh.normal_of[vertex]];
                sum = add(sum, parts[number][i]);
            }
    }
    std::vector<Vector3> normals(sums.size(), Vector3{0, 0, 1});
    for_each_in_parallel(sums.size(), [&](std::size_t i) {
        const Double3 &sum = sums[mesh.normal_of.empty() ? i : mesh.normal_of[i]];
        if (const double size = length(sum); size > 1e-12)
            normals[i] = to_float(scale(sum, 1 / size));
    });
    return normals;
}

double surface_area(const Mesh &mesh) {
    double area = 0;
    for (const auto &t : mesh.triangles)
        area += 0.5 * length(area_vector(mesh, t));
    return area;
}

std::uint64_t mesh_bytes(const Mesh &mesh) {
    std::uint64_t of_attributes = 0;
    for (const MeshAttribute &attribute : mesh.attributes)
        of_attributes += attribute.values.size() * sizeof attribute.values[0];
    return of_attributes + mesh.positions.size() * sizeof mesh.positions[0] +
           mesh.normals.size() * sizeof mesh.normals[0] + mesh.texcoords.size() * sizeof mesh.texcoords[0] +
           mesh.triangles.size() * sizeof mesh.triangles[0];
}

BuiltMesh build_mesh(Mesh mesh, const Matrix4 &to_world, const MeshOptions &options) {
    BuiltMesh built;
    if (options.face_normals)
        mesh.normals.clear();
    transform_positions(mesh, to_world);
    transform_normals(mesh, to_world, options.normals_keep_proportions);
    built.degenerate = drop_degenerate(mesh);
    hide_unused(mesh);

    if (options.front_from_local_winding) {
        // A mirror turns the winding over but not the side that a mapped normal points to.
        if (determinant(to_world) < 0)
            reverse_winding(mesh);
    } else if (!mesh.normals.empty())
        wind_along_normals(mesh);

    if (mesh.normals.empty() && options.compute_normals && !options.face_normals)
        mesh.normals = smooth_vertex_normals(mesh);
    settle_normals(mesh);
    mesh.normal_of = {};

    if (options.flip_normals) {
        reverse_winding(mesh);
        for (Vector3 &n : mesh.normals)
            n = {-n.x, -n.y, -n.z};
    }
    built.mesh = std::move(mesh);
    return built;
}

} // namespace gradus
