// A second short render before a render: what photons would make of a scene whose light may come through glass or
// mirrors onto rougher surfaces. That is what paths from the camera find by chance or not at all, and a pilot of such
// paths does not know what it has not found; photons do.
#pragma once

#include "methods/method.h"
#include "methods/photons/light_paths.h"
#include "planning/pilot.h"

#include <cstdint>

namespace gradus {

/// Whether there are lights, surfaces too smooth to gather photons at, and others.
bool may_ask_for_photons(const Scene &scene, const RenderOptions &options);

/// relMSE of images of one pass of the pilot, or of one half of the pilot of gpt, relative to what photons say.
struct PhotonErrors {
    double gpm = 0;        ///< but for what the radius does
    double gpm_radius = 0; ///< square of the bias by the radius, and two standard errors of its estimate
    double pt = 0, gpt = 0;
    double missed = 0; ///< square of what the photons' image has and that of paths has not; three standard errors less
};

/// From two independent images of gpm with layers and the layer `bias`, G, and two of gpt with layers, W. Of the primal
/// images,
///   (G_1 - W_1) (G_2 - W_2) has the square of the difference of their expectations as its mean,
/// whatever the noise of the four. It holds the bias that the radius makes, of which b_1 b_2 tells the square. The rest
/// is light that paths find so seldom that the pilot has none of it: it stays, while what is found falls with the
/// number of samples.
PhotonErrors estimate_photon_errors(const Image &photons_1, const Image &photons_2, const Image &paths_1,
                                    const Image &paths_2);

struct PhotonPilot {
    PhotonErrors errors;
    double cost = 0;                      ///< of a pass and pixel of the pilot, in rays of a path tracer
    std::uint64_t light_paths = 0;        ///< of such a pass
    double photons = 0;                   ///< of such a pass
    std::uint64_t film_pixels = 1u << 18; ///< of the render
    double seconds = 0;                   ///< rendering, kernels compiled
};

/// Renders a pass of each of two seeds that are far from the render's, with so few photons that this is a small part of
/// a render of so many samples a pixel.
PhotonPilot run_photon_pilot(Device &device, const Scene &scene, const RenderOptions &options, const Pilot &pilot,
                             std::uint64_t samples_per_pixel);

} // namespace gradus
