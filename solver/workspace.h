// What all parts of a solver share: its grids, its sums, its kernels.
//
// Linear systems are solved for a group of channels at a time, and what that takes, some eight planes a channel, is
// there for one group. On a CPU a group is one channel: what an iteration touches of one channel of a common image
// stays in the last-level cache, where that of three would come from memory anew for each kernel. Those of small images
// go together, which takes fewer launches, and elsewhere all do, which fills the device, unless its memory is short.
#pragma once

#include "solver/linear_solver.h"

#include <map>
#include <memory>
#include <vector>

namespace gradus::solver {

/// How many channels make a group.
std::uint32_t channels_together(const DeviceDescription &device, const Grid &grid, std::uint32_t channels,
                                Precision precision);

struct Workspace {
    /// `together` 0: what channels_together() says.
    Workspace(Device &device, std::uint32_t width, std::uint32_t height, std::uint32_t channels, Precision precision,
              std::uint32_t together);

    const std::uint32_t channels, together;
    const PlaneMaker make;
    Multigrid multigrid;
    Sums sums;
    LinearSolver linear;

    System &system() { return multigrid.system(); }
    const Grid &grid() const { return multigrid.system().grid; }

    std::vector<Planes> groups() const;
    /// Those planes of a buffer that has one for each channel.
    Buffer of_group(const Buffer &all, Planes group) const { return make.some(all, grid(), group); }

    /// Compiles them when they are first asked for.
    Kernels &kernels(Weights weights);
    /// For what does not depend on weights, kernels that the solve needs anyway: each set takes a while to load.
    Kernels &any_kernels() { return kernels(any_); }
    void set_any_kernels(Weights weights) { any_ = weights; }
    /// All that were asked for so far.
    std::map<Weights, std::unique_ptr<Kernels>> &all_kernels() { return kernels_; }

  private:
    std::map<Weights, std::unique_ptr<Kernels>> kernels_;
    Weights any_ = Weights::uniform;
};

} // namespace gradus::solver
