// Which photons are gathered at which gather points: pairs, listed window by window.
#pragma once

#include "methods/photons/photon_map.h"
#include "runtime/wavefront/wavefront.h"

#include <cstdint>
#include <functional>

namespace gradus {

/// Pairs that are listed at one time: rows [0, pairs) of `pair_gather`, a row of `gather` each, and of `pair_photon`, a
/// row of `photon_sorted`. Pairs of a gather point follow each other; the list of a range of gather points is the same
/// whatever its windows.
struct PairWindow {
    std::uint32_t first = 0;        ///< row of `gather` from which on find() was asked
    std::uint32_t from = 0;         ///< the gather points of the window: rows first + from on of `gather`
    std::uint32_t rows = 0;         ///< how many; the first and the last may have pairs in other windows too
    std::uint32_t window_first = 0; ///< place in the list of these gather points at which the window begins
    std::uint32_t pairs = 0;
};

class PhotonPairs {
  public:
    /// A batch has at least so many rows unless a smaller one is asked for, however few pixels there are: windows go by
    /// it, and each has its launches.
    static constexpr std::uint32_t least_batch = 8192;

    /// Declares the stages that list pairs and sum over them.
    /// indexed: find() is asked for places in the table `gather_index`, which has rows of `gather`, not for such rows.
    PhotonPairs(Stages &stages, bool indexed = false);

    /// `pair_gather`, `pair_photon`, `pair_value` and what the search takes; all by the batch.
    TableList tables() const;
    /// The rows of tables of pairs for such a batch: to be set as "pair_rows".
    static std::uint32_t pair_rows(std::uint32_t batch);
    /// To be called once they are allocated.
    void attach(Tables &tables);

    /// Finds the photons within the radius of gather points in `rows` of `gather`, as kernels/stages/photon_pairs.cl
    /// has it. Calls `visit` for each window, which launches what works on pairs. Returns how many pairs there were.
    std::uint64_t find(Range rows, const std::function<void(const PairWindow &)> &visit);

    /// For stages that sum over the pairs of a window as sum() does: its definitions and numbers.
    StageDeclaration sum_stage(const char *name) const;

    /// Adds `pair_value` to the sums of the window's gather points.
    void sum(const PairWindow &window) { sum(sum_, 1, window); }
    /// The same by such a stage, of so many planes.
    static void sum(Stage &stage, std::uint32_t planes, const PairWindow &window);

    /// Of the radii of all gather points for which photons were looked for.
    double radius_sum() const { return radius_sum_; }

  private:
    double radius_sum_ = 0;
    bool indexed_;
    Stage &count_, &scan_, &list_, &sum_;
    Tables *tables_ = nullptr;
};

} // namespace gradus
