// How far away what the camera sees is.
#pragma once

#include "runtime/wavefront/session.h"

namespace gradus {

/// The median distance, world units, at which rays through a lattice of some hundred points of the full film meet the
/// scene; the scene's diameter where they meet nothing. These rays are not counted.
double seen_distance(Session &session);

} // namespace gradus
