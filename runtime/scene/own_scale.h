// Scenes of any unit, rendered in one in which areas, squared areas and squared radii stay within what a float holds.
#pragma once

#include "runtime/scene/scene.h"

#include <functional>
#include <string>

namespace gradus {

/// Multiplies all lengths of a scene by the returned power of two, by which it becomes about 1 large; by 1, so not at
/// all, where it is from a thousandth to a million large. Where its triangles are too small then, it becomes larger, by
/// as much as they need and at most a million large. The picture stays as it is: lengths alone change, and
/// intensities of point lights with their square. Depths of the image are to be divided by the factor. Scenes that are
/// larger or smaller and have not been through this lose light without a word.
///
/// Throws Error(ExitCode::scene) where a shape is a billion times smaller than the scene, or the scene is larger than
/// floats are: then one shape or the other cannot be seen. `warn` is told of a camera so far away that places on the
/// scene are known worse than they are seen.
double bring_to_own_scale(Scene &scene, const std::function<void(const std::string &)> &warn = {});

} // namespace gradus
