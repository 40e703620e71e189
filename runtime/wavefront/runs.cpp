#include "runtime/wavefront/runs.h"

#include <stdexcept>

namespace gradus {

namespace {

StageDeclaration runs_stage(const Sort &sort, const std::string &step, std::vector<std::string> numbers,
                            const std::vector<std::string> &tables) {
    StageDeclaration stage;
    stage.name = sort.name() + " runs " + step;
    stage.file = "runs";
    stage.entry = "runs_" + step;
    stage.numbers = std::move(numbers);
    for (const std::string &table : tables)
        stage.tables.emplace_back(table.starts_with("run_") ? table : "sort_" + table, sort.name() + "_" + table);
    return stage;
}

StageDeclaration sum_stage(const Sort &sort, std::uint32_t columns) {
    StageDeclaration stage = runs_stage(sort, "sum", {"sum_rows", "value_rows", "first_column"},
                                        {"index", "run_begin", "run_end", "run_count", "run_sum"});
    stage.tables.emplace_back("run_value", sort.name() + "_run_sum"); // until the values are known
    stage.is_wanted = columns > 0;
    stage.strict = true;
    return stage;
}

} // namespace

Runs::Runs(Stages &stages, const Sort &sort, std::uint32_t columns)
    : sort_(sort), columns_(columns),
      count_(stages.add(runs_stage(sort, "count", {"rows", "chunk_rows"}, {"key", "run_place"}))),
      scan_(stages.add(runs_stage(sort, "scan", {"chunks"}, {"run_place", "run_count"}))),
      list_(stages.add(
          runs_stage(sort, "list", {"rows", "chunk_rows"}, {"key", "run_place", "run_key", "run_begin", "run_end"}))),
      sum_(stages.add(sum_stage(sort, columns))) {}

TableList Runs::tables() const {
    TableList list;
    for (const char *table : {"_run_key", "_run_begin", "_run_end"})
        list.push_back({.name = sort_.name() + table,
                        .rows = sort_.capacity().rows_of,
                        .multiple = sort_.capacity().multiple,
                        .is_uint = true});
    list.push_back({.name = sort_.name() + "_run_sum",
                    .rows = sort_.capacity().rows_of,
                    .multiple = sort_.capacity().multiple,
                    .columns = columns_});
    list.push_back(
        {.name = sort_.name() + "_run_place", .rows = RowsOf::one, .columns = sort_.most_chunks(), .is_uint = true});
    list.push_back({.name = sort_.name() + "_run_count", .rows = RowsOf::one, .is_uint = true, .is_cleared = true});
    return list;
}

void Runs::attach(Tables &tables) { tables_ = &tables; }

void Runs::find(std::uint32_t count) {
    if (count > tables_->rows_of(sort_.name() + "_run_begin"))
        throw std::logic_error("more rows than the runs of " + sort_.name() + " have room for");
    rows_ = count;
    const Chunks chunks = sort_.chunks_of(count);
    count_.run(chunks.number, {{"rows", count}, {"chunk_rows", chunks.rows}});
    scan_.run(1, {{"chunks", chunks.number}});
    list_.run(chunks.number, {{"rows", count}, {"chunk_rows", chunks.rows}});
}

void Runs::sum(const Buffer &values, std::uint32_t value_rows, std::uint32_t first, std::uint32_t columns) {
    if (columns > columns_)
        throw std::logic_error(sort_.name() + " has no room for so many columns of sums");
    sum_.bind("run_value", values);
    const auto sum_rows =
        static_cast<std::uint32_t>(tables_->rows().of(sort_.capacity().rows_of)) * sort_.capacity().multiple;
    // The host does not know how many runs there are, and need not wait for it: there are no more than rows.
    sum_.run_planes(0, rows_, columns, {{"sum_rows", sum_rows}, {"value_rows", value_rows}, {"first_column", first}});
}

std::uint32_t Runs::number() const {
    std::uint32_t number = 0;
    (*tables_)[sort_.name() + "_run_count"].read(&number, sizeof number);
    return number;
}

} // namespace gradus
