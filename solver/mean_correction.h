// Brings local means of an L1 reconstruction back to those of I0.
//
// The L1 norm follows medians: where the noise of I0 is skewed, as that of rare bright samples is, energy is lost. The
// correction is |I| c, where c is smooth: it minimises
//     sum over edges of |I| (D c)^2  +  smoothness^2 sum over pixels of |I| (c - t / |I|)^2,   t = I0 - I, cut,
// |I| being that of the darker pixel for an edge. Summing the equations shows that the sum of the correction is that of
// t. What is longer than about 2 pi / smoothness pixels passes. Relative to |I|, nothing leaks from bright surfaces
// into dark ones, as it does where c is added. t is cut at the third largest |t| of each block of SOLVER_BLOCK x
// SOLVER_BLOCK pixels: a firefly or two count no more than the next brightest, while where many pixels are bright, none
// is cut.
#pragma once

#include "solver/problem.h"

#include <vector>

namespace gradus::solver {

class MeanCorrection {
  public:
    explicit MeanCorrection(Workspace &workspace);
    /// Adds the correction to problem.u(). Returns its mean by channel. Replaces the weights of the hierarchy.
    std::vector<double> add(Kernels &kernels, Problem &problem);

  private:
    Workspace &workspace_;
    std::uint32_t blocks_x_, blocks_y_, columns_;
    Buffer largest_, bound_, right_side_, correction_, corrected_;
};

} // namespace gradus::solver
