#include "runtime/io/plugins/parameters_of_shapes.h"

namespace gradus {

void claim_attachments(Properties &properties) {
    properties.objects("bsdf");
    properties.objects("emitter");
    properties.ignore({"silhouette_sampling_weight"});
}

BuiltMesh build_shape_mesh(Properties &properties, Mesh mesh, MeshOptions options) {
    claim_attachments(properties);
    options.face_normals |= properties.boolean("face_normals", false);
    options.flip_normals |= properties.boolean("flip_normals", false);
    return build_mesh(std::move(mesh), properties.transform("to_world"), options);
}

} // namespace gradus
