// Texture coordinates that a PLY file gives by the corners of its faces, where a mesh has them by its vertices.
#pragma once

#include "runtime/scene/scene.h"

#include <array>
#include <vector>

namespace gradus {

/// Splits each vertex whose corners have different coordinates. What else it has, all of its parts have, and they share
/// a computed normal. by_corner: three for each triangle. Vertices that no triangle has are dropped.
void set_corner_texcoords(Mesh &mesh, const std::vector<std::array<float, 2>> &by_corner);

} // namespace gradus
