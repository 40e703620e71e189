// What paths add to pixels that are not their own: splats, which the film divides by the number of such paths.
#pragma once

#include "runtime/wavefront/session.h"
#include "runtime/wavefront/sort.h"
#include "runtime/wavefront/stage.h"
#include "runtime/wavefront/table.h"

#include <cstdint>

namespace gradus {

/// Sums that are the same bits always: each pixel's splats are added to its compensated sum one by one, in a fixed
/// order, without atomics. The sums depend on that order alone, neither on threads, work-groups, or the other pixels'
/// splats, nor on how many there are in a call: to add some and then others is to add all at once.
class Splats {
  public:
    /// In which order those of a pixel are added.
    enum class Order {
        rows, ///< as they lie
        /// By the path that they are of, and those of a path as they lie. So rows may be written as paths go on,
        /// however these are mixed: with calls for consecutive paths, the image is the same for any batch size.
        paths
    };

    /// Declares the stages of the sort `splat_sorted`, and `splat`. There is room for `multiple` rows for each of
    /// `rows_of`.
    Splats(Session &session, Stages &stages, RowsOf rows_of, std::uint32_t multiple, Order order);

    /// Tables to be written: `splat` (kernels/shared/tables.h), in the kernels of which `splat_rows` is its rows;
    /// `splat_pixel`, the pixel of the crop, or splat_none; with Order::paths, `splat_path`, a number that grows with
    /// the path. And those of the sort, and `splat_film`, which Film::image() reads and Film::clear() clears.
    TableList tables() const;
    /// To be called once they are allocated; all is zero.
    void attach(Tables &tables);

    /// Adds rows [0, count). With Order::paths no splat_path among them is above `highest_path`; the lower that is, the
    /// less there is to do. Splats that are NaN or infinite are left out and counted. On two cores a row costs 10 ns,
    /// with Order::paths 15; but a pixel's splats are added by one work-item, at some 5 ns each.
    void add(std::uint32_t count, std::uint32_t highest_path = 0xFFFFFFFFu);

  private:
    Session &session_;
    RowsOf rows_of_;
    std::uint32_t multiple_;
    Order order_;
    Sort sort_;
    Stage &splat_;
    Tables *tables_ = nullptr;
};

} // namespace gradus
