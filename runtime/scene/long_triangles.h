// Long thin triangles, of which single precision knows little: those of a cylinder, and of what was drawn by machines.
#pragma once

#include "runtime/scene/scene.h"

namespace gradus {

/// Lets long triangles begin at the corner opposite to their longest edge, from which their area and plane are known
/// best: errors of the tracer, and how far rays start off the triangle with them, go by the product of the edges from
/// there over the area (kernels/lib/scene_triangle.h). Left as they are: triangles of which that is little from any
/// corner, and meshes whose triangles have places in textures by their corners' order.
void begin_at_widest_corners(Scene &scene);

/// Whether a surface is of triangles so long, on average over its area, that a ray in some ten thousand gets through
/// between two of them where the tracer has no mind to that.
bool has_long_triangles(const Scene &scene);

} // namespace gradus
