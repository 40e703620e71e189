#include "runtime/wavefront/table_layout.h"

#include "kernels/shared/tables.h"

#include <map>

namespace gradus {

namespace {

#define GRADUS_REAL_COLUMN(table, column, text) {#column, false},
#define GRADUS_UINT_COLUMN(table, column, text) {#column, true},
#define GRADUS_LAYOUT(table, COLUMNS)                                                                                  \
    {#table, {{COLUMNS(GRADUS_REAL_COLUMN, GRADUS_UINT_COLUMN)}, [](const TableSizes &sizes) -> std::size_t {          \
                  [[maybe_unused]] const auto [capacity, slots, pixels, crop_width, own_rows, photon_rows,             \
                                               new_photon_rows, pair_rows, gather_rows, chain_rows, chain_vertices,    \
                                               traced_rows] = sizes;                                                   \
                  return ROWS_OF_##table;                                                                              \
              }}},

const std::map<std::string, TableLayout> layouts = {GRADUS_TABLES(GRADUS_LAYOUT)};

} // namespace

const TableLayout *table_layout(const std::string &argument) {
    const std::string old = "_old";
    std::string table = argument.ends_with(old) ? argument.substr(0, argument.size() - old.size()) : argument;
    if (table.starts_with("back_")) // of the walk back
        table = table.substr(5);
    if (table == "direct") // columns of `radiance`
        table = "radiance";
    const auto found = layouts.find(table);
    return found == layouts.end() ? nullptr : &found->second;
}

} // namespace gradus
