// The L1 norm by iteratively reweighted least squares.
//
// Each reweighting gives every equation the weight 1 / (|residual| + regularisation) and improves u by a few steps of
// preconditioned conjugate gradients. Weights differ by many orders of magnitude, and plain conjugate gradients need
// thousands of steps there; a multigrid cycle over the weights themselves needs two. Weighted least squares majorises
// the L1 norm, so steps may be extrapolated (by less than twice) without rising, which about halves their number.
//
// The regularisation starts well above the typical residual, where the problem is nearly one of least squares, and is
// halved each time. Scale and stop must not follow a few outliers, whose terms may be all but the whole norm: the scale
// is a mean of fourth roots, the decrease is that of the norm with its terms cut at ten scales.
#pragma once

#include "solver/problem.h"

namespace gradus::solver {

class Reweighting {
  public:
    explicit Reweighting(Workspace &workspace) : workspace_(workspace) {}
    /// Leaves the solution in problem.u().
    void run(Kernels &kernels, Problem &problem, double alpha, const Inputs &images, const PoissonOptions &options,
             PoissonReport &report);

  private:
    struct Norm {
        double all = 0, cut = 0;
    };
    /// Sets u to where the iteration starts.
    void start(Kernels &kernels, Problem &problem, double alpha, const Inputs &images);
    /// A typical |residual| of an edge at u.
    double scale_of(Kernels &kernels, Problem &problem);
    /// Sets the weights for u and returns the norm of u, and the norm with each term cut at `cut`.
    Norm reweight(Kernels &kernels, Problem &problem, double alpha, double scale, double regularisation, double cut);

    Workspace &workspace_;
};

} // namespace gradus::solver
