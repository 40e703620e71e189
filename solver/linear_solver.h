// Solves A u = b for one set of weights: Jacobi, conjugate gradients, multigrid cycles. A group of channels at a time
// (solver/workspace.h); each channel stops where it would stop by itself, so groups do not change a bit.
#pragma once

#include "solver/multigrid.h"
#include "solver/poisson_solver.h"
#include "solver/sums.h"

#include <functional>
#include <memory>
#include <vector>

namespace gradus::solver {

/// What a linear solve did.
struct LinearReport {
    int iterations = 0;
    bool converged = false;
    /// ||b - A u|| / ||b|| over all channels: at the start and after each iteration; or, where `noise` was asked for,
    /// the root of the error over the noise before each. A channel that needs fewer keeps its last.
    std::vector<double> residuals;
};

class LinearSolver {
  public:
    LinearSolver(const PlaneMaker &make, Multigrid &multigrid, Sums &sums, std::uint32_t together);

    struct Request {
        LinearMethod method = LinearMethod::multigrid;
        double tolerance = 0; ///< on the relative residual of each channel
        /// Above 0, of preconditioned conjugate gradients: the expected <e, A e> of the solution's noise e, in each
        /// channel. They end with the first step that begins where the same of the solver's own error is below
        /// tolerance^2 of it. The error is taken to be <z, r>, z the preconditioned residual r, which every step needs
        /// anyway. (It is up to four times that, before the step and after, where weights jump; to go by how fast <z,
        /// r> falls is worse: the first step takes most of it off, later ones far less.)
        double noise = 0;
        int iterations = 0;         ///< at most
        double damping = 1;         ///< Jacobi's step
        bool smooths_after = false; ///< cycles that precondition smooth on the way up, too
        /// The mean of the solution is next to free: once rounding errors are all that is left, preconditioned steps
        /// would be long and along it. They end where small residuals grow.
        bool may_drift = false;
        bool watch = true; ///< false: does all iterations, reads nothing back, and reports no residuals
    };

    /// The right side of a group, in a buffer of its own.
    using RightSide = std::function<const Buffer &(Planes group)>;
    /// Improves `u`, which has all channels, group by group; the weights are those of the hierarchy's finest system
    /// (with coarse ones where the method needs them). `b` must not be the hierarchy's right side. `reference_norm`: a
    /// lower bound to the ||b|| that residuals are relative to, for right sides that are rounding errors alone.
    LinearReport solve(Kernels &kernels, const Request &request, const std::vector<Planes> &groups, const RightSide &b,
                       const Buffer &u, double reference_norm = 0);
    /// The same for one group, whose channels alone `b` and `u` have. Does all iterations and reports nothing.
    void improve(Kernels &kernels, Request request, Planes group, const Buffer &b, const Buffer &u);

  private:
    struct Progress;
    void run(Kernels &kernels, const Buffer &b, const Buffer &u, Progress &progress);
    void residual(Kernels &kernels, const Buffer &b, const Buffer &u, Planes channels);
    void jacobi(Kernels &kernels, const Buffer &b, const Buffer &u, Progress &progress);
    void multigrid(Kernels &kernels, const Buffer &b, const Buffer &u, Progress &progress);
    void conjugate_gradients(Kernels &kernels, bool preconditioned, const Buffer &b, const Buffer &u,
                             Progress &progress);
    /// Copies some planes, counted within the group.
    void copy(Kernels &kernels, const Buffer &from, const Buffer &to, Planes planes);

    const PlaneMaker make_;
    Multigrid &multigrid_;
    Sums &sums_;
    std::uint32_t together_;
    /// Made when a method first asks for them, for one group. Conjugate gradients use the hierarchy's right side as
    /// their residual. `kept_`: channels that are finished before others of their group.
    Buffer directions_[2], image_, other_, kept_;
};

} // namespace gradus::solver
