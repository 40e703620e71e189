// Rows brought together by bin.
#pragma once

#include "runtime/wavefront/stage.h"
#include "runtime/wavefront/table.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gradus {

/// The counting sort of kernels/stages/partition.cl: stable, and rows of bin_none are left out. Reads the table
/// `<prefix>bin` and writes `<prefix>index`, the rows bin by bin; both are its owner's, and so is
/// `<prefix>chunk_offset`, which has `bins` rows for each chunk.
class Partition {
  public:
    /// Declares the stages `<name> count`, `<name> scan` and `<name> scatter`.
    Partition(const Session &session, Stages &stages, const std::string &name, const std::string &prefix);

    /// What sorting by at most so many bins takes besides.
    TableList tables(std::uint32_t most_bins) const;
    /// To be called once they are allocated.
    void attach(const Tables &tables) { tables_ = &tables; }

    /// Sorts rows [0, rows). Returns where each bin begins in the index, and where the last ends. Waits for the counts,
    /// while the device still scatters.
    std::vector<std::uint32_t> run(std::uint32_t rows, std::uint32_t bins);

  private:
    StageDeclaration step(const std::string &name, const char *entry, std::vector<std::string> numbers,
                          const std::vector<std::string> &arguments, bool is_wanted) const;
    std::string prefix_;
    std::uint32_t lanes_; ///< that scan
    Stage &count_, &scan_, &share_, &scan_shares_, &scatter_;
    const Tables *tables_ = nullptr;
};

} // namespace gradus
