#include "runtime/io/plugins/parameters_of_shapes.h"

#include <utility>

namespace gradus {

namespace {
/// The other options as they are, and to_world.
Matrix4 read_placement(Properties &properties, MeshOptions &options) {
    if (options.compute_normals)
        options.face_normals |= properties.boolean("face_normals");
    options.flip_normals |= properties.boolean("flip_normals");
    return properties.transform("to_world");
}
} // namespace

ParameterList parameters_of_any_shape() {
    return joined({{{"to_world", Takes::transform, nullptr, "from the shape's own space"},
                    {"flip_normals", Takes::boolean, "false", "the front becomes the back"},
                    {"bsdf", Takes::objects, nullptr, "one, or diffuse 0.5; of a shape that emits black"},
                    {"emitter", Takes::objects, nullptr, "one of type area"},
                    {"medium", Takes::objects, nullptr, "an error, or left out; so are subsurface and volume"},
                    {"subsurface", Takes::objects},
                    {"volume", Takes::objects}},
                   meaningless({"silhouette_sampling_weight", "face_normals"})});
}

ParameterList parameters_of_meshes() {
    ParameterList list = parameters_of_any_shape();
    std::erase_if(list, [](const Parameter &parameter) { return parameter.name == "face_normals"; });
    list.push_back({"face_normals", Takes::boolean, "false", "flat triangles, whatever normals there are"});
    return joined({list, meaningless({"max_smooth_angle"})});
}

PendingMesh made_shape_mesh(Properties &properties, Mesh mesh, const MeshOptions &options, const Double3 &origin) {
    PendingMesh pending{[made = std::move(mesh)] { return SerializedMesh{made}; }, {}, options};
    pending.to_world = multiply(read_placement(properties, pending.options), translation(origin));
    return pending;
}

PendingMesh pending_shape_mesh(Properties &properties, std::function<SerializedMesh()> read) {
    if (properties.has("max_smooth_angle"))
        properties.diagnostics().warn(properties.location_of("max_smooth_angle"),
                                      "\"max_smooth_angle\" is not supported: normals stay as they are");
    PendingMesh mesh{std::move(read), {}, {}};
    mesh.to_world = read_placement(properties, mesh.options);
    return mesh;
}

void turn_texcoords_over(Mesh &mesh) {
    for (auto &[u, v] : mesh.texcoords)
        v = 1 - v;
}

} // namespace gradus
