#include "runtime/wavefront/grouping.h"

#include <fmt/format.h>

namespace gradus {

namespace {

StageDeclaration step(const std::string &name, const char *entry, std::vector<std::string> numbers,
                      const std::vector<std::string> &arguments) {
    StageDeclaration stage = {.name = fmt::format("{} {}", name, entry),
                              .file = "partition",
                              .entry = fmt::format("partition_{}", entry),
                              .definitions = {{"PARTITION_CHUNK", std::to_string(partition_chunk)}},
                              .numbers = std::move(numbers)};
    for (const std::string &argument : arguments)
        stage.tables.emplace_back(argument, fmt::format("{}_{}", name, argument));
    return stage;
}

} // namespace

Grouping::Grouping(Stages &stages, const std::string &name, std::uint32_t bins, RowsOf rows_of, std::uint32_t multiple)
    : name_(name), bins_(bins), rows_of_(rows_of), multiple_(multiple),
      count_(stages.add(step(name, "count", {"bins", "rows"}, {"bin", "chunk_offset"}))),
      scan_(stages.add(step(name, "scan", {"bins", "chunks"}, {"chunk_offset", "range"}))),
      scatter_(stages.add(step(name, "scatter", {"bins", "rows"}, {"bin", "chunk_offset", "index"}))),
      ranges_(bins + 1, 0) {}

TableList Grouping::tables() const {
    TableList list;
    for (const char *table : {"bin", "index", "chunk_offset"}) // a chunk has many rows, so the last is large enough
        list.push_back({.name = name_ + "_" + table, .rows = rows_of_, .multiple = multiple_, .is_uint = true});
    list.push_back({.name = name_ + "_range", .rows = RowsOf::one, .columns = bins_ + 1, .is_uint = true});
    return list;
}

void Grouping::run(std::uint32_t rows) {
    if (rows == 0) {
        ranges_.assign(bins_ + 1, 0);
        return;
    }
    const std::uint32_t chunks = chunks_of(rows);
    count_.run(chunks, {{"bins", bins_}, {"rows", rows}});
    scan_.run(1, {{"bins", bins_}, {"chunks", chunks}});
    Buffer::Reading reading =
        (*tables_)[name_ + "_range"].start_read(ranges_.data(), ranges_.size() * sizeof(ranges_[0]));
    scatter_.run(chunks, {{"bins", bins_}, {"rows", rows}});
    reading.wait();
}

} // namespace gradus
