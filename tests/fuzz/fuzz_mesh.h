// What every reader of meshes owes.
#pragma once

#include "runtime/scene/mesh_builder.h"
#include "runtime/scene/scene.h"

#include <cstdlib>

namespace gradus {

inline void require(bool holds) {
    if (!holds)
        std::abort(); // libFuzzer keeps the input
}

/// All indices are in range, and the mesh can be built.
inline void check_mesh(Mesh mesh) {
    require(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
    require(mesh.texcoords.empty() || mesh.texcoords.size() == mesh.positions.size());
    for (const auto &triangle : mesh.triangles)
        for (std::uint32_t index : triangle)
            require(index < mesh.positions.size());
    build_mesh(std::move(mesh), {}, {});
}

} // namespace gradus
