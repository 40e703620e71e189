// Textures laid out as the kernels read them (kernels/shared/texture.h).
#pragma once

#include "runtime/scene/scene_tables.h"

namespace gradus {

/// (u, v) of the corners; of a mesh that has none those of the unit triangle.
void add_triangle_texcoords(const Mesh &mesh, const std::array<std::uint32_t, 3> &triangle, SceneTables &tables);

/// All textures of the scene, their pictures and, by material record, which parameters they stand for. Throws
/// Error(ExitCode::device) for more texels than kernels can name.
void add_textures(const Scene &scene, SceneTables &tables);

/// By material record, what it blends and the kind that it is of.
void add_blends(const Scene &scene, SceneTables &tables);

} // namespace gradus
