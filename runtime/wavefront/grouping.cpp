#include "runtime/wavefront/grouping.h"

namespace gradus {

Grouping::Grouping(const Session &session, Stages &stages, const std::string &name, std::uint32_t bins, RowsOf rows_of,
                   std::uint32_t multiple)
    : name_(name), bins_(bins), rows_of_(rows_of), multiple_(multiple), partition_(session, stages, name, name + "_"),
      ranges_(bins + 1, 0) {}

TableList Grouping::tables() const {
    TableList list = partition_.tables(bins_);
    for (const char *table : {"_bin", "_index"})
        list.push_back({.name = name_ + table, .rows = rows_of_, .multiple = multiple_, .is_uint = true});
    // All bins of each chunk: a chunk has more rows than there are bins, and where rows are less than a chunk there are
    // still those of a line of memory.
    const std::uint32_t lines = (bins_ + odd_lines(1) - 1) / odd_lines(1);
    list.push_back({.name = name_ + "_chunk_offset",
                    .rows = rows_of_,
                    .multiple = lines <= multiple_ ? multiple_ : multiple_ + lines,
                    .is_uint = true});
    return list;
}

void Grouping::run(std::uint32_t rows) {
    ranges_ = rows > 0 ? partition_.run(rows, bins_) : std::vector<std::uint32_t>(bins_ + 1, 0);
}

} // namespace gradus
