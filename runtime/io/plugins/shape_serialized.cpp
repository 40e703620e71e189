// <shape type="serialized">: one mesh of a file in Mitsuba's own format.
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_shape_serialized() {
    return {
        "one mesh of a file in Mitsuba's own format, versions 3 and 4",
        joined({{Parameter{"filename", Takes::filename, nullptr, "the file"}.required(),
                 Parameter{"shape_index", Takes::integer, "0", "which of its meshes"}.at_least(0).at_most(0xffffffff)},
                parameters_of_meshes()})};
}

ShapeGeometry shape_serialized(Properties &properties, SceneBuilder &builder) {
    const std::filesystem::path path = builder.find_file(properties);
    const auto index = std::uint64_t(properties.integer("shape_index"));
    const std::shared_ptr<MeshFile> file = builder.shared_mesh_file(path, properties.location());
    // The flag in the file counts in 0.x; Mitsuba 3 goes by the parameter alone.
    const bool is_legacy = properties.element().is_legacy();
    return pending_shape_mesh(properties, [file, index, is_legacy, limits = builder.limits(),
                                           attributes = builder.wanted_attributes()] {
        SerializedMesh serialized = parse_serialized(file->bytes(), file->path().string(), index, limits, attributes);
        serialized.face_normals &= is_legacy;
        return serialized;
    });
}

} // namespace gradus
