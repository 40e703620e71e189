#include "runtime/io/ply_corner_texcoords.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <utility>

namespace gradus {

namespace {

/// The values of the vertices that `from` names, one after the other.
template <class Value>
void gather(std::vector<Value> &values, const std::vector<std::uint32_t> &from, std::size_t count = 1) {
    if (values.empty())
        return;
    std::vector<Value> gathered;
    gathered.reserve(from.size() * count);
    for (const std::size_t vertex : from)
        for (std::size_t i = vertex * count; i < (vertex + 1) * count; ++i)
            gathered.push_back(values[i]);
    values = std::move(gathered);
}

} // namespace

void set_corner_texcoords(Mesh &mesh, const std::vector<std::array<float, 2>> &by_corner) {
    // Sorted, and by their bits: a file may have one vertex in all of its faces, and what is no number.
    const auto key = [&](std::size_t corner) {
        const auto [u, v] = by_corner[corner];
        return std::tuple(mesh.triangles[corner / 3][corner % 3], std::bit_cast<std::uint32_t>(u),
                          std::bit_cast<std::uint32_t>(v));
    };
    std::vector<std::size_t> corners(by_corner.size());
    std::iota(corners.begin(), corners.end(), std::size_t(0));
    std::ranges::sort(corners, {}, key);
    std::vector<std::uint32_t> from; // by vertex of the split mesh
    std::vector<std::array<float, 2>> texcoords;
    std::vector<std::array<std::uint32_t, 3>> triangles(mesh.triangles.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const std::size_t corner = corners[i];
        if (i == 0 || key(corners[i - 1]) != key(corner)) {
            const std::uint32_t vertex = std::get<0>(key(corner)), number = std::uint32_t(from.size());
            mesh.normal_of.push_back(number > 0 && from.back() == vertex ? mesh.normal_of.back() : number);
            from.push_back(vertex);
            texcoords.push_back(by_corner[corner]);
        }
        triangles[corner / 3][corner % 3] = std::uint32_t(from.size() - 1);
    }
    gather(mesh.positions, from);
    gather(mesh.normals, from);
    for (MeshAttribute &attribute : mesh.attributes)
        if (!is_by_face(attribute.name))
            gather(attribute.values, from, attribute.channels);
    mesh.texcoords = std::move(texcoords);
    mesh.triangles = std::move(triangles);
}

} // namespace gradus
