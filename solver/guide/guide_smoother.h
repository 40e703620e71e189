// Sums over neighbourhoods with Gaussian weights, for the parts that make and judge guides.
#pragma once

#include "solver/grid.h"

namespace gradus::solver {

class GuideSmoother {
  public:
    /// Weights exp(-d^2 / (2 sigma^2)) up to a distance of `radius` (at most SOLVER_MARGIN) in each direction.
    GuideSmoother(const PlaneMaker &make, const Grid &grid, int radius, double sigma);

    /// Writes the weighted sums of so many planes of `image`, which is zero outside of the image, to `smoothed`.
    void run(const Buffer &image, const Buffer &smoothed, std::uint32_t planes);
    /// Lets go of memory that run() needed.
    void release() { across_ = {}; }

  private:
    const PlaneMaker make_;
    const Grid grid_;
    Kernel rows_, columns_;
    Buffer taps_, across_;
};

/// The planes of images that have guides. Throws Error(ExitCode::usage) for a size of 0.
Grid guide_grid(std::uint32_t width, std::uint32_t height);

/// Compiles all kernels of guides, several at a time; uses no queue.
void compile_guide_kernels(Device &device, const KernelLibrary::Progress &progress = {});

/// Compiles a kernel of kernels/solver/FILE.cl for guides of three channels.
Kernel guide_kernel(Device &device, Precision precision, const char *file, const char *entry, int taps = 0);

} // namespace gradus::solver
