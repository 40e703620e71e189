#include "runtime/wavefront/partition.h"

#include <algorithm>

namespace gradus {

namespace {

/// On a processor one lane scans faster than a launch more takes; elsewhere a lane waits for each of its loads.
constexpr std::uint32_t lanes_elsewhere = 512;

} // namespace

Partition::Partition(const Session &session, Stages &stages, const std::string &name, const std::string &prefix)
    : prefix_(prefix), lanes_(session.device.description().is_host ? 1 : lanes_elsewhere),
      count_(stages.add(step(name + " count", "count", {"bins", "rows"}, {"bin", "chunk_offset"}, true))),
      scan_(stages.add(step(name + " scan", "scan", {"bins", "chunks"}, {"chunk_offset", "range"}, lanes_ == 1))),
      share_(
          stages.add(step(name + " share", "share", {"bins", "chunks"}, {"chunk_offset", "share_count"}, lanes_ > 1))),
      scan_shares_(stages.add(step(name + " scan", "scan_shares", {"bins", "chunks"},
                                   {"share_count", "chunk_offset", "range"}, lanes_ > 1))),
      scatter_(
          stages.add(step(name + " scatter", "scatter", {"bins", "rows"}, {"bin", "chunk_offset", "index"}, true))) {}

StageDeclaration Partition::step(const std::string &name, const char *entry, std::vector<std::string> numbers,
                                 const std::vector<std::string> &arguments, bool is_wanted) const {
    StageDeclaration stage = {.name = name,
                              .file = "partition",
                              .entry = std::string("partition_") + entry,
                              .definitions = {{"PARTITION_CHUNK", std::to_string(partition_chunk)}},
                              .is_wanted = is_wanted,
                              .numbers = std::move(numbers)};
    for (const std::string &argument : arguments)
        stage.tables.emplace_back(argument, prefix_ + argument);
    return stage;
}

TableList Partition::tables(std::uint32_t most_bins) const {
    return {
        {.name = prefix_ + "range", .rows = RowsOf::one, .columns = most_bins + 1, .is_uint = true},
        {.name = prefix_ + "share_count", .rows = RowsOf::one, .columns = lanes_ > 1 ? lanes_ : 0, .is_uint = true}};
}

std::vector<std::uint32_t> Partition::run(std::uint32_t rows, std::uint32_t bins) {
    // One at least, so that the scan leaves ranges of no rows where there are none.
    const std::uint32_t chunks = std::max(chunks_of(rows), 1u);
    count_.run(chunks, {{"bins", bins}, {"rows", rows}});
    scan_.run(1, {{"bins", bins}, {"chunks", chunks}});
    share_.run(lanes_, {{"bins", bins}, {"chunks", chunks}});
    scan_shares_.run(lanes_, {{"bins", bins}, {"chunks", chunks}});
    std::vector<std::uint32_t> ranges(bins + 1);
    Buffer::Reading reading =
        (*tables_)[prefix_ + "range"].start_read(ranges.data(), ranges.size() * sizeof(std::uint32_t));
    scatter_.run(chunks, {{"bins", bins}, {"rows", rows}});
    reading.wait();
    return ranges;
}

} // namespace gradus
