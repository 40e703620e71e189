// The method `auto`: path tracing or gradient-domain path tracing, whichever is nearer the truth at equal cost.
#pragma once

#include "methods/method.h"
#include "planning/pilot.h"

#include <memory>

namespace gradus {

/// The method of less error at equal cost, from what the pilot found, or pt where it found no figures.
MethodChoice choose_by_pilot(const Pilot &pilot);

/// Picks by a pilot (pilot.h), or by a rule where the render is too short for one. What it returns gives the very image
/// of the method that was picked; its statistics say which and why. Throws Error.
std::unique_ptr<Method> make_automatic_method(Device &device, const Scene &scene, const RenderOptions &options);

} // namespace gradus
