// Photons in the order of the cells of a grid, so that those near a point are few runs of rows.
#pragma once

#include "runtime/wavefront/session.h"
#include "runtime/wavefront/sort.h"
#include "runtime/wavefront/stage.h"
#include "runtime/wavefront/table.h"

#include <array>
#include <cstdint>

namespace gradus {

/// The grid as kernels know it (kernels/lib/photon_grid.h).
struct PhotonGrid {
    std::array<double, 3> low{};
    double inverse_edge = 1;
    double reach = 0; ///< how far off positions may be by rounding
    std::array<std::uint32_t, 3> last{};
    std::uint32_t line_stride = 1, line_shift = 0;
    std::uint32_t keys = 1; ///< one more than the highest

    /// Cells of edge `edge`, or a little more where a side would have too many. Each has a key of its own where that
    /// takes no more than `most_keys`; else lines of cells are hashed.
    PhotonGrid(const Bounds &box, double edge, std::uint32_t most_keys);
};

class PhotonMap {
  public:
    /// Declares the stages that sort. Until `photon` grows there is room for `rows` photons.
    PhotonMap(Session &session, Stages &stages, std::uint32_t rows);

    /// `photon_sorted`, of the columns of `photon`; `photon_line_sorted`, the line of cells of each; `photon_first`,
    /// where the photons of each key begin. And what sorting takes.
    TableList tables() const;
    /// To be called once they are allocated.
    void attach(Tables &tables);

    /// Sorts the `count` photons that `photon_order` names, of the first `rows` of `photon`, into cells of edge `edge`,
    /// world units. The smaller these are the fewer photons beyond the radius are looked at, and the more cells: about
    /// the radius is best. Photons of a cell stay in that order. Where `photon` has grown, so do the tables of this.
    void build(std::uint32_t rows, std::uint32_t count, double edge);

  private:
    Stages &stages_;
    Bounds box_;
    std::uint32_t rows_, columns_;
    Sort sort_;
    Stage &cells_, &copy_, &lines_, &starts_;
    Tables *tables_ = nullptr;

    void grow();
};

} // namespace gradus
