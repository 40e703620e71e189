// <shape type="obj">: a Wavefront OBJ file as one mesh.
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_shape_obj() {
    return {"a Wavefront OBJ file as one mesh",
            joined({{Parameter{"filename", Takes::filename, nullptr, "the file"}.required(),
                     {"flip_tex_coords", Takes::boolean, "true", "v becomes 1 − v"}},
                    parameters_of_meshes(),
                    meaningless({"load_materials", "collapse", "shape_index"})})};
}

ShapeGeometry shape_obj(Properties &properties, SceneBuilder &builder) {
    const std::shared_ptr<MeshFile> file = builder.mesh_file(builder.find_file(properties), properties.location());
    const bool flip = properties.boolean("flip_tex_coords"); // most files count v from the image's bottom
    return pending_shape_mesh(properties, [file, flip] {
        const std::string &text = file->bytes();
        Mesh mesh = parse_obj(text, file->path().string(), file->place());
        if (flip)
            for (auto &[u, v] : mesh.texcoords)
                v = 1 - v;
        return SerializedMesh{std::move(mesh)};
    });
}

} // namespace gradus
