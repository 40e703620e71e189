// How far away what the camera sees is.
#pragma once

#include "runtime/wavefront/session.h"

#include <vector>

namespace gradus {

/// The distances, world units, at which rays through a lattice of some thousand points of the full film meet the scene;
/// the scene's diameter alone where they meet nothing. These rays are not counted.
std::vector<double> seen_distances(Session &session);

} // namespace gradus
