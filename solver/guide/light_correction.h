// Gives a guided image back the light that its guide has lost.
//
// A value that is noisy is trusted less, and where noise is rare and bright, what is bright looks noisy: so the feature
// filter loses light, of 4 samples up to a tenth. The mean U of two unbiased halves has it, somewhere around. What U
// has more than the image G is averaged over a neighbourhood, relative to brightness: in four passes, each of five
// pixels across and five down, 1, 2, 4 and 8 pixels apart (a trous: Holschneider et al. 1989), pixels counting
// exp(-d^2 / (2 0.3^2)) where the logarithms of their brightness differ by d, so that highlights keep their light to
// themselves. Each pixel gets its brightness times that, at most 0.3 of it: more is a firefly. U - G is the share of
// the guide that was followed times what the guide is off by, so the correction goes as samples grow, as the guide
// does.
//
// What is followed where a denoiser is the guide is left as it is: it loses no light.
#pragma once

#include "solver/grid.h"

#include <array>

namespace gradus {

class LightCorrection {
  public:
    /// Throws Error(ExitCode::usage) for a size of 0.
    LightCorrection(Device &device, std::uint32_t width, std::uint32_t height, Precision precision = Precision::single);

    /// Corrects `image`. All are of three channels, planes as PoissonImages has them. `share`: of the samples that the
    /// first half has.
    void run(const std::array<const Buffer *, 2> &halves, double share, Buffer &image);

  private:
    const solver::PlaneMaker make_;
    const solver::Grid grid_;
    Kernel lost_, pass_, give_back_;
};

} // namespace gradus
