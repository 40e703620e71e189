// <shape type="rectangle">: [-1, 1]^2 in the plane z = 0, its front towards +z.
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_shape_rectangle() {
    return {"[−1, 1]² in the plane z = 0, its front towards +z", parameters_of_any_shape()};
}

ShapeGeometry shape_rectangle(Properties &properties, SceneBuilder &) {
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    MeshOptions options;
    options.front_from_local_winding = true;
    options.compute_normals = false; // flat
    return made_shape_mesh(properties, std::move(mesh), options);
}

} // namespace gradus
