// <shape type="disk">: the unit disk in the plane z = 0, its front towards +z.
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

#include <cmath>
#include <numbers>

namespace gradus {

Declaration declare_shape_disk() {
    return {"radius 1 in the plane z = 0, its front towards +z; a polygon of 256 corners and the disk's area, within "
            "5e-5 of the radius",
            parameters_of_any_shape()};
}

ShapeGeometry shape_disk(Properties &properties, SceneBuilder &) {
    // A regular polygon of the disk's area: its edge departs from the circle by 5e-5 of the radius, to either side.
    constexpr std::uint32_t corners = 256;
    constexpr double turn = 2 * std::numbers::pi / corners;
    const double radius = std::sqrt(turn / std::sin(turn));
    Mesh mesh;
    for (std::uint32_t i = 0; i < corners; ++i) {
        // Texture coordinates are radius and angle, so the center is another vertex for each triangle.
        mesh.positions.push_back({0, 0, 0});
        mesh.texcoords.push_back({0, (float(i) + 0.5f) / corners});
        for (std::uint32_t corner = i; corner <= i + 1; ++corner) {
            mesh.positions.push_back({float(radius * std::cos(corner % corners * turn)),
                                      float(radius * std::sin(corner % corners * turn)), 0});
            mesh.texcoords.push_back({1, float(corner) / corners});
        }
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    MeshOptions options;
    options.front_from_local_winding = true;
    options.compute_normals = false; // flat
    return made_shape_mesh(properties, std::move(mesh), options);
}

} // namespace gradus
