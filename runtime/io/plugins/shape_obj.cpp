// <shape type="obj">: a Wavefront OBJ file as one mesh.
//   filename, to_world, face_normals, flip_normals, flip_tex_coords (true)
#include "runtime/io/mesh_files.h"
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

ShapeGeometry shape_obj(Properties &properties, SceneBuilder &builder) {
    const std::filesystem::path path = builder.find_file(properties);
    Mesh mesh = parse_obj(builder.file_bytes(path, properties.location(), true), path.string());
    if (properties.boolean("flip_tex_coords", true)) // most files count v from the image's bottom
        for (auto &[u, v] : mesh.texcoords)
            v = 1 - v;
    properties.ignore({"load_materials", "collapse", "shape_index"});
    return build_shape_mesh(properties, std::move(mesh), {});
}

} // namespace gradus
