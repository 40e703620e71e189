// <shape type="serialized">: one mesh of a file in Mitsuba's own format.
//   filename, shape_index (0), to_world, face_normals, flip_normals
#include "runtime/io/mesh_files.h"
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

ShapeGeometry shape_serialized(Properties &properties, SceneBuilder &builder) {
    const std::filesystem::path path = builder.find_file(properties);
    const auto index = std::uint64_t(properties.integer("shape_index", 0, 0, 0xffffffff));
    const std::string &data = builder.file_bytes(path, properties.location(), false);
    SerializedMesh serialized = parse_serialized(data, path.string(), index, builder.limits());
    builder.count_mesh_bytes(serialized.unfolded_bytes, properties.location());
    MeshOptions options;
    // The flag in the file counts in 0.x; Mitsuba 3 goes by the parameter alone.
    options.face_normals = serialized.face_normals && properties.element().is_legacy();
    return build_shape_mesh(properties, std::move(serialized.mesh), options);
}

} // namespace gradus
