// Solves A u = b for one set of weights: Jacobi, conjugate gradients, multigrid cycles.
//
// On a CPU the channels are solved one after the other: what an iteration touches of one channel of a common image
// stays in the last-level cache, where that of three would come from memory anew for each kernel. Elsewhere all go
// together, which fills the device.
#pragma once

#include "solver/multigrid.h"
#include "solver/poisson_solver.h"
#include "solver/sums.h"

#include <memory>
#include <vector>

namespace gradus::solver {

/// What a linear solve did.
struct LinearReport {
    int iterations = 0;
    bool converged = false;
    /// ||b - A u|| / ||b|| over all channels: at the start and after each iteration. A channel that needs fewer keeps
    /// its last.
    std::vector<double> residuals;
};

class LinearSolver {
  public:
    LinearSolver(const PlaneMaker &make, Multigrid &multigrid, Sums &sums, std::uint32_t channels);

    struct Request {
        LinearMethod method = LinearMethod::multigrid;
        double tolerance = 0; ///< on the relative residual of each channel
        int iterations = 0;   ///< at most
        double damping = 1;   ///< Jacobi's step
        bool watch = true;    ///< false: does all iterations, reads nothing back, and reports no residuals
    };

    /// Improves `u`; the weights are those of the hierarchy's finest system (with coarse ones where the method needs
    /// them). `b` must not be the hierarchy's right side. `reference_norm`: a lower bound to the ||b|| that residuals
    /// are relative to, for right sides that are rounding errors alone.
    LinearReport solve(Kernels &kernels, const Request &request, const Buffer &b, Buffer &u, double reference_norm = 0);

  private:
    struct Progress;
    void residual(Kernels &kernels, const Buffer &b, const Buffer &u, Planes channels);
    void jacobi(Kernels &kernels, const Buffer &b, Buffer &u, Progress &progress);
    void multigrid(Kernels &kernels, const Buffer &b, Buffer &u, Progress &progress);
    void conjugate_gradients(Kernels &kernels, bool preconditioned, const Buffer &b, Buffer &u, Progress &progress);

    const PlaneMaker make_;
    Multigrid &multigrid_;
    Sums &sums_;
    std::uint32_t channels_;
    /// Made when a method first asks for them. Conjugate gradients use the hierarchy's right side as their residual.
    Buffer directions_[2], image_, other_;
};

} // namespace gradus::solver
