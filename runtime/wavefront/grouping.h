// Rows brought together by what they are, for tables that are no paths in flight.
#pragma once

#include "runtime/wavefront/partition.h"
#include "runtime/wavefront/stage.h"
#include "runtime/wavefront/table.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gradus {

/// A partition with the tables that it needs and what it found last.
class Grouping {
  public:
    /// Declares the stages `<name> count`, `<name> scan` and `<name> scatter`. There is room for `multiple` rows for
    /// each of `rows_of`; at least as many as bins.
    Grouping(const Session &session, Stages &stages, const std::string &name, std::uint32_t bins, RowsOf rows_of,
             std::uint32_t multiple = 1);

    /// `<name>_bin`, to be written by whoever asks; `<name>_index`, the rows bin by bin; and what sorting takes.
    TableList tables() const;
    /// To be called once they are allocated.
    void attach(const Tables &tables) { partition_.attach(tables); }

    /// Sorts rows [0, rows). Waits for the device.
    void run(std::uint32_t rows);
    /// Places in the index of the rows of a bin, and of all bins.
    Range bin(std::uint32_t number) const { return {ranges_[number], ranges_[number + 1] - ranges_[number]}; }
    std::uint32_t count() const { return ranges_.back(); }

  private:
    std::string name_;
    std::uint32_t bins_;
    RowsOf rows_of_;
    std::uint32_t multiple_;
    Partition partition_;
    std::vector<std::uint32_t> ranges_;
};

} // namespace gradus
