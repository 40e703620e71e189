// Brings local means of an L1 reconstruction back to those of I0.
//
// The L1 norm follows medians: where the noise of I0 is skewed, as that of rare bright samples is, energy is lost. The
// correction is |I| c, where c is what a low-pass filter leaves of t / |I|, t = I0 - I, cut. The filter is made of
// passes H: c = H r minimises
//     sum over edges of |I| (D c)^2  +  smoothness^2 sum over pixels of |I| (c - r)^2,
// |I| being that of the darker pixel for an edge. Summing the equations shows that a pass keeps the sum of |I| r, so
// that the sum of the correction is that of t. Relative to |I|, nothing leaks from bright surfaces into dark ones, as
// it does where c is added. A pass leaves 1 / (1 + (k / smoothness)^2) of a wave of k = 2 pi / (pixels): a slow slope,
// which lets noise through that is not wanted and keeps back some of what is. 3 H^2 - 2 H^3 is steeper at both ends: as
// noisy at a smoothness of 0.25 as H alone at 0.2, it leaves half as much of a local loss.
//
// t is cut where it stands out in its block of SOLVER_BLOCK x SOLVER_BLOCK pixels: up to twice the third largest |t|
// there it counts as it is, and beyond the less the larger it is, down to the third largest. So a firefly or two count
// no more than the next brightest, while bright samples that are merely rare count whole.
#pragma once

#include "solver/problem.h"

#include <vector>

namespace gradus::solver {

class MeanCorrection {
  public:
    explicit MeanCorrection(Workspace &workspace);
    /// Adds the correction to problem.u(). Returns its mean by channel. Replaces the weights of the hierarchy and uses
    /// the memory of the gradients, and the problem's to spare.
    std::vector<double> add(Kernels &kernels, Problem &problem);

  private:
    Workspace &workspace_;
    std::uint32_t blocks_x_, blocks_y_, columns_;
    Buffer largest_, bound_;
};

} // namespace gradus::solver
