// <shape type="ply">: a PLY file.
//   filename, to_world, face_normals, flip_normals, flip_tex_coords (false)
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

ShapeGeometry shape_ply(Properties &properties, SceneBuilder &builder) {
    const std::shared_ptr<MeshFile> file = builder.mesh_file(builder.find_file(properties), properties.location());
    const bool flip = properties.boolean("flip_tex_coords", false);
    properties.ignore({"srgb"}); // of vertex colours, which nothing reads
    return pending_shape_mesh(properties, [file, flip] {
        Mesh mesh = parse_ply(file->bytes(), file->path().string());
        if (flip)
            for (auto &[u, v] : mesh.texcoords)
                v = 1 - v;
        return SerializedMesh{std::move(mesh)};
    });
}

} // namespace gradus
