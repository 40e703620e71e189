// <shape type="ply">: a PLY file.
//   filename, to_world, face_normals, flip_normals, flip_tex_coords (false); 0.x: srgb (true), how colours are stored
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

ShapeGeometry shape_ply(Properties &properties, SceneBuilder &builder) {
    const std::shared_ptr<MeshFile> file = builder.mesh_file(builder.find_file(properties), properties.location());
    const bool flip = properties.boolean("flip_tex_coords", false);
    const bool is_srgb = properties.boolean("srgb", properties.element().is_legacy());
    return pending_shape_mesh(properties, [file, flip, is_srgb, attributes = builder.wanted_attributes()] {
        Mesh mesh = parse_ply(file->bytes(), file->path().string(), attributes);
        if (flip)
            for (auto &[u, v] : mesh.texcoords)
                v = 1 - v;
        for (MeshAttribute &attribute : mesh.attributes)
            if (is_srgb && attribute.name.ends_with("color"))
                for (float &value : attribute.values)
                    value = float(srgb_to_linear(value));
        return SerializedMesh{std::move(mesh)};
    });
}

} // namespace gradus
