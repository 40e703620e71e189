// What every shape plugin reads.
#pragma once

#include "runtime/io/plugins/plugin.h"
#include "runtime/io/properties.h"
#include "runtime/scene/mesh_builder.h"

namespace gradus {

/// to_world, flip_normals (false), face_normals (false): builds the mesh. What `options`
/// already sets stays set.
BuiltMesh build_shape_mesh(Properties &properties, Mesh mesh, MeshOptions options);
/// The same of a mesh that is read later.
PendingMesh pending_shape_mesh(Properties &properties, std::function<SerializedMesh()> read);
/// Marks what hangs on a shape and is read by the scene builder: its BSDF and its emitter.
void claim_attachments(Properties &properties);

} // namespace gradus
