// Rows of equal keys after a sort, and sums over them.
#pragma once

#include "runtime/wavefront/sort.h"

#include <cstdint>
#include <string>

namespace gradus {

/// The segmented sum: photons by cell, samples by pixel. On two cores a row costs 1 to 4 ns to find the runs, less
/// where there are many, and 2 to 4 ns for each column that is summed; but a run is summed by one work-item, row by
/// row.
class Runs {
  public:
    /// Declares the stages `<sort> runs count`, `<sort> runs scan`, `<sort> runs list` and `<sort> runs sum`. At most
    /// `columns` are summed at once; with 0 there are no sums. `sort` must outlive this.
    Runs(Stages &stages, const Sort &sort, std::uint32_t columns);

    /// `<sort>_run_key`, `<sort>_run_begin`, `<sort>_run_end`, a uint a row of the sort each; `<sort>_run_count`, one
    /// uint; `<sort>_run_sum`, `columns` columns of reals. And a few thousand bytes.
    TableList tables() const;
    /// To be called once they are allocated.
    void attach(Tables &tables);

    /// Lists the runs of the `count` rows that were sorted last. Run r has the key `run_key`[r] and the places
    /// `run_begin`[r] to `run_end`[r] of the sort's index. Keys ascend; so what the sort counted as above the highest
    /// is the last run. On no rows, there are none. Throws std::logic_error for more rows than the sort had room for
    /// when tables were allocated: these do not grow with it.
    void find(std::uint32_t count);
    /// Sums columns [first, first + columns) of `values`, a table of reals with `value_rows` rows, over the runs that
    /// find() found: column c of `<sort>_run_sum` at row r. Values are picked by the index and added in the order of
    /// the rows, compensated: the sum is off by little more than its last place, and the same bits however rows are
    /// shared out. What is not finite makes the sum of its run so. Throws std::logic_error for more columns than there
    /// are.
    void sum(const Buffer &values, std::uint32_t value_rows, std::uint32_t first, std::uint32_t columns);

    /// Waits for the device.
    std::uint32_t number() const;

  private:
    const Sort &sort_;
    std::uint32_t columns_;
    Stage &count_, &scan_, &list_, &sum_;
    Tables *tables_ = nullptr;
    std::uint32_t rows_ = 0; ///< that find() saw
};

} // namespace gradus
