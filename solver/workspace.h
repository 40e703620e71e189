// What all parts of a solver share: its grids, its sums, its kernels.
#pragma once

#include "solver/linear_solver.h"

#include <map>
#include <memory>

namespace gradus::solver {

struct Workspace {
    Workspace(Device &device, std::uint32_t width, std::uint32_t height, std::uint32_t channels, Precision precision)
        : channels(channels), make(device, precision), multigrid(make, width, height, channels),
          sums(make, multigrid.system().grid, channels), linear(make, multigrid, sums, channels) {}

    const std::uint32_t channels;
    const PlaneMaker make;
    Multigrid multigrid;
    Sums sums;
    LinearSolver linear;

    System &system() { return multigrid.system(); }
    const Grid &grid() const { return multigrid.system().grid; }

    /// Compiles them when they are first asked for.
    Kernels &kernels(Weights weights) {
        std::unique_ptr<Kernels> &kernels = kernels_[weights];
        if (!kernels)
            kernels = std::make_unique<Kernels>(make.device(), make.precision(), channels, weights);
        return *kernels;
    }
    /// All that were asked for so far.
    std::map<Weights, std::unique_ptr<Kernels>> &all_kernels() { return kernels_; }

  private:
    std::map<Weights, std::unique_ptr<Kernels>> kernels_;
};

} // namespace gradus::solver
