// What a render allocates on the device: one list, from which sizes, the bound of a batch, the statistics and the
// layouts of tests and benchmarks come.
#pragma once

#include "runtime/device/buffer.h"
#include "runtime/device/precision.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace gradus {

/// What a table has rows for. A batch is the paths that are in flight at once; a pass is more paths than that, and each
/// has a slot: when some end, others begin in their rows.
enum class RowsOf { path, slot, chain, pixel, image_row, chunk, one };

/// A structure of arrays (kernels/shared/tables.h): `columns` columns of `multiple` rows for each path, slot, pixel...
/// A table of no columns is not allocated.
struct TableDeclaration {
    std::string name = {}; ///< as kernels' arguments have it
    RowsOf rows = RowsOf::path;
    std::uint32_t multiple = 1;
    std::uint32_t columns = 1;
    bool is_uint = false;    ///< all columns are uint; else elements are `real`, and a uint lies in a real's place
    bool alternates = false; ///< there are two: `name` is the newest, `name`_old the one before
    bool is_cleared = false; ///< kernels may read rows that nobody wrote
    bool grows = false;      ///< Tables::grow() may give it more rows
};

using TableList = std::vector<TableDeclaration>;

/// Rows of a table, or places in the index of a partition.
struct Range {
    std::uint32_t first = 0, count = 0;
    std::uint32_t end() const { return first + count; }
};

/// The numbers that sizes depend on.
struct TableRows {
    std::uint32_t paths = 0;  ///< in flight: a batch
    std::uint32_t slots = 0;  ///< of a pass, those beside it counted in
    std::uint32_t pixels = 0; ///< of the crop
    std::uint32_t width = 0;  ///< of the crop
    std::uint32_t chunks = 0; ///< of the partition
    std::uint32_t chains = 0; ///< that are walked at once

    std::uint64_t of(RowsOf rows) const;
};

/// Rows that each work-item of the partition counts.
constexpr std::uint32_t partition_chunk = 256;
constexpr std::uint32_t chunks_of(std::uint32_t rows) { return (rows + partition_chunk - 1) / partition_chunk; }

/// Bytes of one table of a declaration.
std::uint64_t table_bytes(const TableDeclaration &table, const TableRows &rows, Precision precision);

/// The tables of a list, allocated. Throws Error where there is no memory.
class Tables {
  public:
    Tables(Device &device, const TableList &list, const TableRows &rows, Precision precision);

    const TableRows &rows() const { return rows_; }
    Precision precision() const { return precision_; }
    bool has(const std::string &name) const { return tables_.contains(name); }
    /// The table of that name; the newest of two. Throws std::logic_error where there is none.
    Buffer &operator[](const std::string &name);
    const Buffer &operator[](const std::string &name) const;

    /// Gives a table that grows `multiple` in place of its declaration's, and keeps its content. Waits for the device.
    void grow(const std::string &name, std::uint32_t multiple);
    /// Rows of a table.
    std::uint64_t rows_of(const std::string &name) const;

    /// Lets go of the memory of all tables but these; kernels may not be launched any more.
    void release_all_but(const std::vector<std::string> &kept);

    /// Of those that alternate, the newest becomes the old one.
    void exchange() { newest_ = 1 - newest_; }
    int newest() const { return newest_; }
    /// Another number whenever a table that may change has become another buffer.
    std::uint64_t version() const { return 2 * grown_ + std::uint64_t(newest_); }

    /// Calls visit(argument, buffer, changes) for what kernels may name, as it is now.
    template <class Visit>
    void for_each(Visit visit) const {
        for (const auto &[name, table] : tables_) {
            const bool alternates = table.declaration.alternates;
            visit(name, table.buffer[alternates ? newest_ : 0], alternates || table.declaration.grows);
            if (alternates)
                visit(name + "_old", table.buffer[1 - newest_], true);
        }
    }

  private:
    struct Entry {
        Buffer buffer[2];
        TableDeclaration declaration;
    };
    const Entry &entry(const std::string &name) const;
    Device &device_;
    std::map<std::string, Entry> tables_;
    TableRows rows_;
    Precision precision_;
    int newest_ = 0;
    std::uint64_t grown_ = 0;
};

/// Rows for so many, a few more than those: an odd number of cache lines. For tables of which kernels read or write
/// many columns at once, at rows that are not quite in order: columns a power of two apart would share the same few
/// lines of the caches. Where rows are in order, as most of paths are, it gains nothing.
std::uint32_t odd_lines(std::uint32_t rows);

/// Passes are this many batches long.
constexpr std::uint32_t batches_a_pass = 4;

/// Paths in flight where nobody asks for another number; twice as many where they take little memory.
std::uint32_t default_batch_size(const Device &device);

/// The batch size for a request (0: the device's default): bounded by half of the device's memory and by its largest
/// allocation, for the tables of the list with a pass of batches_a_pass batches, and by the samples that there are.
/// Throws Error where not even a small batch fits.
std::uint32_t choose_batch_size(Device &device, std::uint32_t requested, std::uint64_t samples, const TableList &list,
                                Precision precision);

} // namespace gradus
