// <shape type="obj">: a Wavefront OBJ file as one mesh.
//   filename, to_world, face_normals, flip_normals, flip_tex_coords (true)
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

ShapeGeometry shape_obj(Properties &properties, SceneBuilder &builder) {
    const std::shared_ptr<MeshFile> file = builder.mesh_file(builder.find_file(properties), properties.location());
    const bool flip = properties.boolean("flip_tex_coords", true); // most files count v from the image's bottom
    properties.ignore({"load_materials", "collapse", "shape_index"});
    return pending_shape_mesh(properties, [file, flip] {
        Mesh mesh = parse_obj(file->bytes(), file->path().string());
        if (flip)
            for (auto &[u, v] : mesh.texcoords)
                v = 1 - v;
        return SerializedMesh{std::move(mesh)};
    });
}

} // namespace gradus
