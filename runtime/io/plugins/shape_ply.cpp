// <shape type="ply">: a PLY file.
//   filename, to_world, face_normals, flip_normals, flip_tex_coords (false)
#include "runtime/io/mesh_files.h"
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

ShapeGeometry shape_ply(Properties &properties, SceneBuilder &builder) {
    const std::filesystem::path path = builder.find_file(properties);
    Mesh mesh = parse_ply(builder.file_bytes(path, properties.location(), true), path.string());
    if (properties.boolean("flip_tex_coords", false))
        for (auto &[u, v] : mesh.texcoords)
            v = 1 - v;
    properties.ignore({"srgb"}); // of vertex colours, which nothing reads
    return build_shape_mesh(properties, std::move(mesh), {});
}

} // namespace gradus
