// What every reader of meshes owes.
#pragma once

#include "runtime/scene/mesh_builder.h"
#include "runtime/scene/scene.h"

#include <cstdlib>
#include <string>
#include <vector>

namespace gradus {

inline void require(bool holds) {
    if (!holds)
        std::abort(); // libFuzzer keeps the input
}

/// Attributes that readers are asked for.
inline const std::vector<std::string> wanted_attributes = {"vertex_color", "face_color", "vertex_a", "face_a"};

/// All indices are in range, attributes complete, and the mesh can be built.
inline void check_mesh(Mesh mesh) {
    require(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
    require(mesh.texcoords.empty() || mesh.texcoords.size() == mesh.positions.size());
    for (const auto &triangle : mesh.triangles)
        for (std::uint32_t index : triangle)
            require(index < mesh.positions.size());
    for (const MeshAttribute &attribute : mesh.attributes)
        require(attribute.values.size() ==
                attribute.channels * (is_by_face(attribute.name) ? mesh.triangles.size() : mesh.positions.size()));
    build_mesh(std::move(mesh), {}, {});
}

} // namespace gradus
