// How the tables of kernels/shared/tables.h lie in memory, for who looks into them from outside: tests and benchmarks.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace gradus {

struct TableColumn {
    std::string name;
    bool is_uint; ///< a whole number in the place of a real
};

/// What kernels know of the rows of tables: their arguments of these names.
struct TableSizes {
    std::size_t capacity = 0, slots = 0, pixels = 0, crop_width = 0, own_rows = 0, photon_rows = 0, new_photon_rows = 0,
                pair_rows = 0, gather_rows = 0, chain_rows = 0, chain_vertices = 0, traced_rows = 0;
};

struct TableLayout {
    std::vector<TableColumn> columns; ///< all that there are: a scene may do without the last ones
    std::size_t (*rows)(const TableSizes &sizes);
};

/// The layout of the table that a kernel's argument of this name points to, which may be `direct` or end in `_old`;
/// null where it is none of kernels/shared/tables.h.
const TableLayout *table_layout(const std::string &argument);

} // namespace gradus
