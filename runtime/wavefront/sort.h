// A stable sort of rows by keys of up to 32 bits.
#pragma once

#include "runtime/wavefront/session.h"
#include "runtime/wavefront/stage.h"
#include "runtime/wavefront/table.h"

#include <cstdint>
#include <string>

namespace gradus {

/// Rows as work-items share them: each has `rows` in turn, the last one what is left.
struct Chunks {
    std::uint32_t rows = 0, number = 0;
};

/// A radix sort on the device. On two cores a row costs 1.2 ns for each byte of the key and 1.5 ns beside that. The
/// result is the same for any number of threads and any size of work-groups.
class Sort {
  public:
    /// Declares the stages `<name> begin`, `<name> again`, `<name> count`, `<name> total` and `<name> scatter`. There
    /// is room for `multiple` rows for each of `rows_of`. `name` is that of no other sort.
    Sort(const Session &session, Stages &stages, const std::string &name, RowsOf rows_of, std::uint32_t multiple = 1);

    /// The result, `<name>_key` and `<name>_index`, and what it takes: 16 bytes a row, and 0.28 to 1.1 MB.
    TableList tables() const;
    /// To be called once they are allocated.
    void attach(Tables &tables);
    /// Makes room for `multiple` rows for each of `rows_of`; the result of run() is lost.
    void grow(std::uint32_t multiple);

    /// Sorts rows [0, count) by `keys`, a uint a row, which stay as they are. Keys above `highest` all count as
    /// highest + 1 and come last. The lower `highest`, the less there is to do. Throws std::logic_error where there are
    /// more rows than room.
    void run(const Buffer &keys, std::uint32_t count, std::uint32_t highest);
    /// The same for the rows that `order` names, `count` uints, each with the key of its row: those of equal keys are
    /// in the order in which it has them. What it does not name does not matter.
    void run_in(const Buffer &order, const Buffer &keys, std::uint32_t count, std::uint32_t highest);
    /// Sorts what run() left by another key of the same `count` rows: those in which it is equal stay in the order that
    /// they have. So this sorts by two keys, of which run() has the less significant one.
    void again(const Buffer &keys, std::uint32_t count, std::uint32_t highest);

    /// The result: the keys in ascending order, and the rows that have them. Rows of equal keys are in ascending order.
    /// What lies beyond the rows that were sorted is not defined.
    const Buffer &keys() const;
    const Buffer &index() const;

    const std::string &name() const { return name_; }
    struct Capacity {
        RowsOf rows_of;
        std::uint32_t multiple;
    };
    Capacity capacity() const { return {rows_of_, multiple_}; }
    Chunks chunks_of(std::uint32_t count) const;
    std::uint32_t most_chunks() const { return most_chunks_; }

  private:
    struct Passes {
        std::uint32_t last = 0; ///< what keys above the highest count as
        std::uint32_t number = 0, bits = 0;
    };
    Passes passes_for(const Buffer &keys, std::uint32_t count, std::uint32_t highest) const;
    struct Side {
        const Buffer &key, &index;
    };
    Side side(bool is_next) const;
    void sort(std::uint32_t count, const Passes &passes);

    std::string name_;
    RowsOf rows_of_;
    std::uint32_t multiple_;
    std::uint32_t most_chunks_;
    Stage &begin_, &again_, &count_, &total_, &scatter_;
    Tables *tables_ = nullptr;
};

} // namespace gradus
