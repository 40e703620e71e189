// Points that shine and lie in a surface, as in the middle of a lamp, or on the floor.
#pragma once

#include "runtime/scene/scene.h"

#include <vector>

namespace gradus {

/// By emitter, how far rays keep off it where they end or begin there, in units of the world: more than the tracer errs
/// by in meeting the surfaces that hold it, so that whether they are in the way is not left to rounding. They are not.
/// 0 where it lies in none, or shines from no point.
std::vector<float> gaps_in_surfaces(const Scene &scene);

} // namespace gradus
