// The direct solution of the L2 problem by FFTW's discrete cosine transforms, in float on the processor: the solver's
// rival.
#pragma once

#include "solver/poisson_solver.h"

#include <cstdint>
#include <memory>

namespace gradus::bench {

/// Solves (alpha^2 + D^T D) I = alpha^2 I0 + D^T G, which the DCT-II makes diagonal, with eigenvalues
/// alpha^2 + 4 - 2 cos(pi i / W) - 2 cos(pi j / H).
class Rival {
  public:
    /// Plans with FFTW_MEASURE: all channels in one transform, and each on its own. The faster way is taken.
    Rival(std::uint32_t width, std::uint32_t height, std::uint32_t channels, int threads);
    ~Rival();
    Rival(const Rival &) = delete;
    Rival &operator=(const Rival &) = delete;

    /// Reads primal, dx and dy. Returns channels * height * width values, which stay until the next call.
    const float *solve(const HostImages &images, double alpha);

    const char *way() const; ///< "all channels in one transform" or "channel by channel"
    double planning_seconds() const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

} // namespace gradus::bench
