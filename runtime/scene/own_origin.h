// Scenes far from the origin, rendered near it, where positions have the bits that the scene needs.
#pragma once

#include "runtime/scene/bounds.h"
#include "runtime/scene/scene.h"
#include "runtime/scene/transform.h"

namespace gradus {

/// The middle of a box that is more than eight times its extent from the origin; of others the origin.
Double3 own_origin_of(const Bounds &bounds);

/// Moves a scene that is more than eight times its extent from the origin to the origin: what lies there rounds by what
/// the scene is large, not by how far away it is. Rays would start off surfaces by a share of their distance from the
/// origin, and the tracer, which knows no double, would let them through between triangles. The picture stays as it is.
void bring_to_own_origin(Scene &scene);

} // namespace gradus
