// Light whose radiance a mesh bears: what it is in the mean over triangles.
#pragma once

#include "runtime/scene/scene.h"

#include <cstddef>

namespace gradus {

/// A texture of kind mesh_attribute in the mean over a triangle of the mesh, which must have the attribute. Exact where
/// the texture clamps nothing; where it does, that of its clamped corners: not less, so 0 only where all of it is 0.
Rgb mean_over_triangle(const Texture &texture, const Mesh &mesh, std::size_t triangle);
/// The same over all of the mesh, by area.
Rgb mean_over_mesh(const Texture &texture, const Mesh &mesh);

} // namespace gradus
