#include "runtime/io/plugins/parameters_of_shapes.h"

#include <utility>

namespace gradus {

namespace {
/// The other options as they are, and to_world.
Matrix4 read_placement(Properties &properties, MeshOptions &options) {
    claim_attachments(properties);
    options.face_normals |= properties.boolean("face_normals", false);
    options.flip_normals |= properties.boolean("flip_normals", false);
    return properties.transform("to_world");
}
} // namespace

void claim_attachments(Properties &properties) {
    properties.objects("bsdf");
    properties.objects("emitter");
    for (const char *tag : {"medium", "subsurface", "volume"})
        properties.objects(tag);
    properties.ignore({"silhouette_sampling_weight"});
}

BuiltMesh build_shape_mesh(Properties &properties, Mesh mesh, MeshOptions options) {
    const Matrix4 to_world = read_placement(properties, options);
    return build_mesh(std::move(mesh), to_world, options);
}

PendingMesh pending_shape_mesh(Properties &properties, std::function<SerializedMesh()> read) {
    PendingMesh mesh{std::move(read), {}, {}};
    mesh.to_world = read_placement(properties, mesh.options);
    return mesh;
}

} // namespace gradus
