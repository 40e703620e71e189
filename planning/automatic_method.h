// The method `auto`: path tracing, gradient-domain path tracing or, where light may come through smooth surfaces,
// gradient-domain photon density estimation, whichever is nearer the truth at equal cost.
#pragma once

#include "methods/method.h"
#include "planning/photon_pilot.h"
#include "planning/row_pilot.h"

#include <memory>

namespace gradus {

/// The method of less error at equal cost of a render of so many samples a pixel, the reconstruction counted in, from
/// what the pilot found, or pt where it found no figures.
MethodChoice choose_by_pilot(const RowPilot &pilot, Reconstruction reconstruction, std::uint64_t samples,
                             std::uint64_t pixels);

/// What to render with, and how long, where a photon pilot was rendered, too: what `choice` says, or gpm for as many
/// passes as cost as much where it is estimated to have less than half of the error then. `samples`: a pixel, of the
/// choice's method.
struct PhotonChoice {
    MethodChoice choice;
    std::uint64_t samples = 0;     ///< a pixel, of its method
    std::uint64_t light_paths = 0; ///< a pass; 0: as options have it
};
PhotonChoice choose_by_photons(MethodChoice choice, const PhotonPilot &pilot, std::uint64_t samples,
                               const RenderOptions &options);

/// Picks by pilots (row_pilot.h, photon_pilot.h), or by a rule where the render is too short for one. What it returns
/// gives the very image of the method that was picked; its statistics say which and why. Throws Error.
std::unique_ptr<Method> make_automatic_method(Device &device, const Scene &scene, const RenderOptions &options);

} // namespace gradus
