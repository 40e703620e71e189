// Which kernel argument is which table of kernels/shared/tables.h, and which of its columns hold whole numbers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gradus::bench {

struct TableLayout {
    std::string rows_argument;      ///< the kernel argument that says how many rows: "capacity", "slots", "pixels"
    std::uint32_t rows_factor = 1;  ///< times this
    std::uint32_t rows_an_item = 1; ///< that a work-item reads or writes: 4 where there is one for each offset path
    std::vector<bool> is_uint;      ///< by column
};

/// The layout of the table that an argument of this name points to; null where it is no table.
const TableLayout *table_layout(const std::string &argument);

} // namespace gradus::bench
