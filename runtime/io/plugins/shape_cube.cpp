// <shape type="cube">: [-1, 1]^3, its front outside.
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_shape_cube() { return {"[−1, 1]³, its front outside", parameters_of_any_shape()}; }

ShapeGeometry shape_cube(Properties &properties, SceneBuilder &) {
    // Each side from its corner (u, v) = (0, 0) along u and along v, placed as Mitsuba has them; v x u points outside.
    struct Side {
        Vector3 corner, along_u, along_v;
    };
    constexpr Side sides[] = {
        {{-1, -1, -1}, {0, 0, 2}, {2, 0, 0}}, {{1, 1, 1}, {-2, 0, 0}, {0, 0, -2}},
        {{1, -1, 1}, {0, 2, 0}, {0, 0, -2}},  {{-1, -1, 1}, {0, 2, 0}, {2, 0, 0}},
        {{-1, -1, -1}, {0, 2, 0}, {0, 0, 2}}, {{-1, 1, -1}, {0, -2, 0}, {2, 0, 0}},
    };
    constexpr std::array<float, 2> corners[] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}}; // (u, v)
    Mesh mesh;
    for (const Side &side : sides) {
        const auto first = std::uint32_t(mesh.positions.size());
        for (const auto &[u, v] : corners) {
            mesh.positions.push_back({side.corner.x + u * side.along_u.x + v * side.along_v.x,
                                      side.corner.y + u * side.along_u.y + v * side.along_v.y,
                                      side.corner.z + u * side.along_u.z + v * side.along_v.z});
            mesh.texcoords.push_back({u, v});
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first + 3, first, first + 2});
    }
    MeshOptions options;
    options.front_from_local_winding = true;
    options.compute_normals = false; // flat
    return made_shape_mesh(properties, std::move(mesh), options);
}

} // namespace gradus
