// The geometry of the solver's planes (kernels/solver/grid.h) and memory for them.
#pragma once

#include "runtime/device/buffer.h"
#include "runtime/device/precision.h"
#include "runtime/device/program.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gradus::solver {

constexpr std::uint32_t quotient_up(std::uint32_t a, std::uint32_t b) { return a / b + (a % b != 0); }

/// The planes that a launch does: channels, or planes of weights.
struct Planes {
    std::uint32_t first = 0, count = 1;
};

struct Grid {
    std::uint32_t width = 0, height = 0;
    std::uint32_t row = 0;   ///< elements from a row to the next
    std::uint32_t plane = 0; ///< elements from a channel to the next

    Grid() = default;
    Grid(std::uint32_t width, std::uint32_t height);

    /// Parts of a sum that a kernel with a work-item for each pixel leaves for each plane.
    std::uint32_t partials() const;
    /// Sets width, height, row and plane.
    void bind(Kernel &kernel) const;
    /// Launches a kernel on all pixels of some planes, after setting the grid and the planes. `rows`:
    /// as many rows of work-items, from `first_row` on, instead of one for each row of pixels.
    void launch(Kernel &kernel, Planes planes, std::uint32_t rows = 0, std::uint32_t first_row = 0) const;
};

/// Makes buffers of `real`, all zero.
class PlaneMaker {
  public:
    PlaneMaker(Device &device, Precision precision) : device_(device), precision_(precision) {}
    Buffer planes(const std::string &name, const Grid &grid, std::uint32_t count) const;
    /// Some planes of a buffer of several.
    Buffer some(const Buffer &all, const Grid &grid, Planes planes) const;
    Buffer reals(const std::string &name, std::size_t count) const;
    Buffer reals(const std::string &name, const std::vector<double> &values) const;
    Precision precision() const { return precision_; }
    Device &device() const { return device_; }

  private:
    Device &device_;
    Precision precision_;
};

/// Launches `lines` times `groups` work-groups of SOLVER_TILE items.
void launch_groups(Kernel &kernel, std::size_t groups, std::size_t lines = 1);

} // namespace gradus::solver
