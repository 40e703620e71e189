#include "methods/photons/photon_pairs.h"

#include "kernels/shared/tables.h"
#include "runtime/error.h"
#include "runtime/wavefront/host_table.h"

#include <algorithm>
#include <string>
#include <vector>

namespace gradus {

using namespace lib_float;

namespace {

// Pairs that are listed at once, for each row of the batch. More would leave the cache between the stages.
constexpr std::uint32_t pairs_a_row = 4;
// Gather points whose pairs are counted together.
constexpr std::uint32_t pair_chunk = 64;
// So many are more than the places of pairs within a chunk can tell apart.
constexpr std::uint32_t too_many_pairs = 0x7FFFFFFF;
// Of `pair_mark` (kernels/stages/photon_pairs.cl).
constexpr std::uint32_t mark_columns = 3;

std::map<std::string, std::string> definitions(const char *list, bool indexed) {
    return {{"LIST", list},
            {"GATHER_INDEXED", indexed ? "1" : "0"},
            {"PAIR_CHUNK", std::to_string(pair_chunk) + "u"},
            {"PAIR_TOO_MANY", std::to_string(too_many_pairs) + "u"}};
}

std::uint32_t chunks_for(std::uint32_t rows) { return (rows + pair_chunk - 1) / pair_chunk; }

} // namespace

PhotonPairs::PhotonPairs(Stages &stages, bool indexed)
    : indexed_(indexed), count_(stages.add({.name = "photon_pairs count",
                                            .file = "photon_pairs",
                                            .definitions = definitions("0", indexed),
                                            .strict = true,
                                            .numbers = {"first", "from"}})),
      scan_(stages.add({.name = "pair_scan", .definitions = definitions("0", indexed), .numbers = {"first", "rows"}})),
      list_(stages.add({.name = "photon_pairs list",
                        .file = "photon_pairs",
                        .definitions = definitions("1", indexed),
                        .strict = true,
                        .numbers = {"first", "from", "window_first", "window_pairs"}})),
      sum_(stages.add(sum_stage("pair_sum"))) {}

StageDeclaration PhotonPairs::sum_stage(const char *name) const {
    return {.name = name,
            .definitions = definitions("0", indexed_),
            .strict = true,
            .numbers = {"first", "from", "window_first", "window_pairs"}};
}

TableList PhotonPairs::tables() const {
    TableList list;
    for (const char *name : {"pair_gather", "pair_photon"})
        list.push_back({.name = name, .multiple = pairs_a_row, .is_uint = true});
    list.push_back({.name = "pair_value", .multiple = pairs_a_row, .columns = pair_value_columns});
    list.push_back({.name = "radius_total"});
    list.push_back({.name = "pair_mark", .columns = mark_columns, .is_uint = true});
    for (const char *name : {"pair_count", "pair_looked", "pair_offset", "pair_total", "pair_chunk_first"})
        list.push_back({.name = name, .is_uint = true});
    return list;
}

std::uint32_t PhotonPairs::pair_rows(std::uint32_t batch) { return batch * pairs_a_row; }

void PhotonPairs::attach(Tables &tables) { tables_ = &tables; }

std::uint64_t PhotonPairs::find(Range rows, const std::function<void(const PairWindow &)> &visit) {
    if (rows.count == 0)
        return 0;
    const std::uint32_t chunks = chunks_for(rows.count), room = pair_rows(tables_->rows().paths);
    count_.run(rows.count, {{"first", rows.first}, {"from", 0}});
    scan_.run(chunks, {{"first", rows.first}, {"rows", rows.count}});
    std::vector<std::uint32_t> totals(chunks);
    (*tables_)["pair_total"].read(totals.data(), chunks * sizeof(totals[0]));
    if (std::ranges::count(totals, too_many_pairs) > 0)
        throw Error(ExitCode::usage, "too many photons lie within the radius of a gather point; try a smaller --radius "
                                     "or fewer --photons");
    {
        const HostTable radii((*tables_)["radius_total"], tables_->rows().paths, tables_->precision());
        for (std::uint32_t chunk = 0; chunk < chunks; ++chunk)
            radius_sum_ += radii.real(0, chunk);
    }

    // Chunks one after the other while there is room for their pairs; one with more has windows of its own.
    struct Group {
        std::uint32_t first, end, pairs;
    };
    std::vector<Group> groups;
    std::uint64_t all = 0;
    {
        const auto mapping = (*tables_)["pair_chunk_first"].map(Access::write);
        for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) {
            if (groups.empty() || std::uint64_t(groups.back().pairs) + totals[chunk] > room)
                groups.push_back({chunk, chunk, 0});
            Group &group = groups.back();
            mapping.as<std::uint32_t>()[chunk] = group.pairs;
            group.end = chunk + 1;
            group.pairs += totals[chunk];
            all += totals[chunk];
        }
    }
    for (const Group &group : groups) {
        PairWindow window;
        window.first = rows.first;
        window.from = group.first * pair_chunk;
        window.rows = std::min(group.end * pair_chunk, rows.count) - window.from;
        for (std::uint32_t begin = 0; begin < group.pairs; begin += window.pairs) {
            window.window_first = begin;
            window.pairs = std::min(room, group.pairs - begin);
            list_.run(window.rows, {{"first", window.first},
                                    {"from", window.from},
                                    {"window_first", window.window_first},
                                    {"window_pairs", window.pairs}});
            visit(window);
        }
    }
    return all;
}

void PhotonPairs::sum(Stage &stage, std::uint32_t planes, const PairWindow &window) {
    stage.run_planes(0, window.rows, planes,
                     {{"first", window.first},
                      {"from", window.from},
                      {"window_first", window.window_first},
                      {"window_pairs", window.pairs}});
}

} // namespace gradus
