// <shape type="ply">: a PLY file.
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_shape_ply() {
    return {"a PLY file, ASCII or binary",
            joined({{Parameter{"filename", Takes::filename, nullptr, "the file"}.required(),
                     {"flip_tex_coords", Takes::boolean, "false", "v becomes 1 − v"},
                     Parameter{"srgb", Takes::boolean, "false", "colours at vertices and faces are stored as sRGB"}
                         .before_2("true")},
                    parameters_of_meshes()})};
}

ShapeGeometry shape_ply(Properties &properties, SceneBuilder &builder) {
    const std::shared_ptr<MeshFile> file = builder.mesh_file(builder.find_file(properties), properties.location());
    const bool flip = properties.boolean("flip_tex_coords");
    const bool is_srgb = properties.boolean("srgb");
    return pending_shape_mesh(properties, [file, flip, is_srgb, attributes = builder.wanted_attributes()] {
        Mesh mesh = parse_ply(file->bytes(), file->path().string(), attributes);
        if (flip)
            turn_texcoords_over(mesh);
        for (MeshAttribute &attribute : mesh.attributes)
            if (is_srgb && attribute.name.ends_with("color"))
                for (float &value : attribute.values)
                    value = float(srgb_to_linear_value(value));
        return SerializedMesh{std::move(mesh)};
    });
}

} // namespace gradus
