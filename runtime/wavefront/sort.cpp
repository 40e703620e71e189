#include "runtime/wavefront/sort.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>

namespace gradus {

namespace {

// Of 4 to 11 bits, 8 were the fastest for all keys and row counts on PoCL: wider ones write to more places at once than
// the first cache and its address table hold.
constexpr std::uint32_t digit_bits = 8, digit_values = 1u << digit_bits;

// Rows of a chunk; fewer would cost more for their counts than they gain by being shared out.
constexpr std::uint32_t least_chunk = 512;

// Counts of different chunks are not a power of two apart, or few of them would fit into a cache at once: that cost as
// much as all the rest.
constexpr std::uint32_t line = 64 / sizeof(std::uint32_t);
constexpr std::uint32_t largest_stride = digit_values + line;

StageDeclaration sort_stage(const std::string &sort, const std::string &step, std::vector<std::string> numbers,
                            const std::vector<std::string> &tables) {
    StageDeclaration stage;
    stage.name = sort + " " + step;
    stage.file = "sort";
    stage.entry = "sort_" + step;
    stage.numbers = std::move(numbers);
    for (const std::string &table : tables) // the keys to sort are bound when they are known
        stage.tables.emplace_back("sort_" + table, sort + "_" + (table == "from" ? "key" : table));
    return stage;
}

/// Two work-groups for each of the device's cores. Each chunk has counts of its own, so that their number is bounded.
std::uint32_t chunks_for(const Session &session) {
    const std::uint32_t group =
        session.options.work_group_size ? session.options.work_group_size : default_work_group_size;
    return std::clamp(2 * session.device.description().compute_units * group, 256u, 1024u);
}

} // namespace

Sort::Sort(const Session &session, Stages &stages, const std::string &name, RowsOf rows_of, std::uint32_t multiple)
    : name_(name), rows_of_(rows_of), multiple_(multiple), most_chunks_(chunks_for(session)),
      begin_(stages.add(sort_stage(name, "begin", {"last"}, {"from", "key", "index"}))),
      again_(stages.add(sort_stage(name, "again", {"last"}, {"from", "index", "key_next", "index_next"}))),
      count_(
          stages.add(sort_stage(name, "count", {"rows", "chunk_rows", "shift", "values", "stride"}, {"key", "place"}))),
      total_(stages.add(sort_stage(name, "total", {"chunks", "stride"}, {"place", "found"}))),
      scatter_(stages.add(sort_stage(name, "scatter", {"rows", "chunk_rows", "shift", "values", "stride"},
                                     {"key", "index", "place", "found", "key_next", "index_next"}))) {}

TableList Sort::tables() const {
    TableList list;
    for (const char *table : {"_key", "_index", "_key_next", "_index_next"})
        list.push_back(
            {.name = name_ + table, .rows = rows_of_, .multiple = multiple_, .is_uint = true, .grows = true});
    list.push_back(
        {.name = name_ + "_place", .rows = RowsOf::one, .columns = most_chunks_ * largest_stride, .is_uint = true});
    list.push_back({.name = name_ + "_found", .rows = RowsOf::one, .columns = digit_values, .is_uint = true});
    return list;
}

void Sort::attach(Tables &tables) { tables_ = &tables; }

void Sort::grow(std::uint32_t multiple) {
    for (const char *table : {"_key", "_index", "_key_next", "_index_next"})
        tables_->grow(name_ + table, multiple);
    multiple_ = multiple;
}

const Buffer &Sort::keys() const { return (*tables_)[name_ + "_key"]; }
const Buffer &Sort::index() const { return (*tables_)[name_ + "_index"]; }

void Sort::run(const Buffer &keys, std::uint32_t count, std::uint32_t highest) {
    const Passes passes = passes_for(keys, count, highest);
    const Side to = side(passes.number % 2 == 1);
    begin_.bind("sort_from", keys);
    begin_.bind("sort_key", to.key);
    begin_.bind("sort_index", to.index);
    begin_.run(count, {{"last", passes.last}});
    sort(count, passes);
}

void Sort::again(const Buffer &keys, std::uint32_t count, std::uint32_t highest) {
    run_in(index(), keys, count, highest);
}

void Sort::run_in(const Buffer &order, const Buffer &keys, std::uint32_t count, std::uint32_t highest) {
    const Passes passes = passes_for(keys, count, highest);
    const Side to = side(passes.number % 2 == 1);
    again_.bind("sort_index", order);
    again_.bind("sort_from", keys);
    again_.bind("sort_key_next", to.key);
    again_.bind("sort_index_next", to.index);
    again_.run(count, {{"last", passes.last}});
    sort(count, passes);
}

Chunks Sort::chunks_of(std::uint32_t count) const {
    const std::uint32_t rows = std::max(least_chunk, (count + most_chunks_ - 1) / most_chunks_);
    return {rows, (count + rows - 1) / rows};
}

Sort::Passes Sort::passes_for(const Buffer &keys, std::uint32_t count, std::uint32_t highest) const {
    if (count > tables_->rows().of(rows_of_) * multiple_ || count > keys.bytes() / sizeof(std::uint32_t))
        throw std::logic_error("more rows than " + name_ + " has room for");
    Passes passes;
    passes.last = highest < std::numeric_limits<std::uint32_t>::max() ? highest + 1 : highest;
    const auto bits = static_cast<std::uint32_t>(std::bit_width(passes.last));
    passes.number = (bits + digit_bits - 1) / digit_bits;
    passes.bits = (bits + passes.number - 1) / passes.number;
    return passes;
}

Sort::Side Sort::side(bool is_next) const {
    const std::string next = is_next ? "_next" : "";
    return {(*tables_)[name_ + "_key" + next], (*tables_)[name_ + "_index" + next]};
}

void Sort::sort(std::uint32_t count, const Passes &passes) {
    const Chunks chunks = chunks_of(count);
    const std::uint32_t values = 1u << passes.bits, stride = values + line;
    for (std::uint32_t pass = 0; pass < passes.number; ++pass) {
        const bool from_next = (passes.number - pass) % 2 == 1; // so that the last one ends in the tables without _next
        const Side from = side(from_next), to = side(!from_next);
        const std::uint32_t shift = pass * passes.bits;
        count_.bind("sort_key", from.key);
        scatter_.bind("sort_key", from.key);
        scatter_.bind("sort_index", from.index);
        scatter_.bind("sort_key_next", to.key);
        scatter_.bind("sort_index_next", to.index);
        const LaunchNumbers numbers = {
            {"rows", count}, {"chunk_rows", chunks.rows}, {"shift", shift}, {"values", values}, {"stride", stride}};
        count_.run(chunks.number, numbers);
        total_.run(values, {{"chunks", chunks.number}, {"stride", stride}});
        scatter_.run(chunks.number, numbers);
    }
}

} // namespace gradus
