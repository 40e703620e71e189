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
    // In 0.x the file's own materials count where the shape has none and nobody says otherwise.
    const bool is_missing_materials =
        properties.element().is_legacy() && !properties.has("load_materials") && properties.objects("bsdf").empty();
    return pending_shape_mesh(properties, [file, flip, is_missing_materials] {
        const std::string &text = file->bytes();
        Mesh mesh = parse_obj(text, file->path().string(), file->place());
        if (flip)
            for (auto &[u, v] : mesh.texcoords)
                v = 1 - v;
        SerializedMesh read{std::move(mesh)};
        if (is_missing_materials && text.find("\nusemtl") != std::string::npos)
            read.warning = file->path().string() + " names materials of an MTL file, which is not read: the shape is " +
                           "gray; give it a BSDF";
        return read;
    });
}

} // namespace gradus
