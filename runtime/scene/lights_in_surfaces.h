// Points that shine and lie in a surface, as in the middle of a lamp, or on the floor.
#pragma once

#include "runtime/scene/scene.h"

#include <vector>

namespace gradus {

/// By place, how far rays keep off it where they end or begin there, in units of the world: more than the tracer errs
/// by in meeting the surfaces that hold it, so that whether they are in the way is not left to rounding. They are not.
/// 0 where the place lies in none.
std::vector<float> gaps_in_surfaces(const Scene &scene, const std::vector<Vector3> &places);

} // namespace gradus
