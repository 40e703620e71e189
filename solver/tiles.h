// Tiles of a grid that a work-group does on its own, with what it needs twice in local memory
// (kernels/solver/cycle.cl).
#pragma once

#include "solver/grid.h"

namespace gradus::solver {

class Tiles {
  public:
    Tiles(const DeviceDescription &device, Precision precision);

    /// Elements of local memory that a tile with its border has at most: LOCAL_REALS of the kernels.
    std::uint32_t local_reals() const { return local_reals_; }
    /// Items that share a line (kernels/solver/vectors.h).
    std::uint32_t lanes() const { return is_host_ ? 1 : 16; }
    /// Launches a kernel on all tiles of a grid, after setting its size and theirs.
    void launch(Kernel &kernel, const Grid &grid, Planes planes) const;

  private:
    struct Shape {
        std::uint32_t columns; ///< a multiple of 16
        std::uint32_t rows;    ///< even
    };
    Shape shape(const Grid &grid) const;

    bool is_host_;
    std::uint32_t fewest_tiles_, local_reals_, widest_;
};

} // namespace gradus::solver
