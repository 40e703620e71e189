// What every shape plugin reads.
#pragma once

#include "runtime/io/plugins/plugin.h"
#include "runtime/io/properties.h"
#include "runtime/scene/mesh_builder.h"

namespace gradus {

/// With what hangs on a shape and is read by the scene builder: its BSDF and its emitter.
ParameterList parameters_of_meshes();
/// The same of a shape whose normals are what they are.
ParameterList parameters_of_any_shape();
/// A mesh by these parameters, of positions relative to `origin`. What `options` already sets stays set.
PendingMesh made_shape_mesh(Properties &properties, Mesh mesh, const MeshOptions &options,
                            const Double3 &origin = {0, 0, 0});
/// The same of a mesh that is read later.
PendingMesh pending_shape_mesh(Properties &properties, std::function<SerializedMesh()> read);

/// v becomes 1 - v.
void turn_texcoords_over(Mesh &mesh);

} // namespace gradus
