// From the sums of a gradient-domain method to its image.
#pragma once

#include "runtime/film/image.h"
#include "runtime/methods/direct_light.h"
#include "runtime/methods/method.h"
#include "runtime/wavefront/host_table.h"
#include "solver/poisson_solver.h"

#include <cstdint>
#include <vector>

namespace gradus {

/// Primal, dx and dy, each R, G and B, and the variances of these means.
struct GradientLayers {
    std::vector<Channel> means, variances;
    std::uint64_t frames = 0; ///< samples of each pixel
};

/// The table of GRADUS_GRADIENT_FILM_COLUMNS after so many samples of each pixel.
GradientLayers read_gradient_film(const HostTable &film, std::size_t pixels, std::uint64_t frames);

/// R, G and B reconstructed, the layers, and what else `whole` holds, the mean of all samples. What it has and the
/// primal has not is what the camera sees of lights, and `edges` know it better where they are; it is added at last, as
/// it is. alpha comes from the variances unless the options say otherwise.
Image reconstruct(PoissonSolver &solver, const Image &whole, const GradientLayers &layers,
                  const std::vector<DirectPixel> &edges, const RenderOptions &options);

} // namespace gradus
