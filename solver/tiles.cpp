#include "solver/tiles.h"

#include <algorithm>

namespace gradus::solver {

namespace {

/// On each side of a tile's line, in local memory.
constexpr std::uint32_t border_columns = 8;

/// A CPU reads long lines faster than short ones (1280 columns over 432: 0.72 of the time), and 64 KiB stay in its
/// second-level cache. Elsewhere many small groups fill the device.
constexpr std::uint32_t most_bytes_of_host = 65536, columns_elsewhere = 112, rows_elsewhere = 8;

/// Of a small grid, so that each core has some; a core of many has one of each channel.
constexpr std::uint32_t fewest_tiles = 16, fewest_rows = 8;

} // namespace

Tiles::Tiles(const DeviceDescription &device, Precision precision)
    : is_host_(device.is_host), fewest_tiles_(std::max(fewest_tiles, device.compute_units)),
      local_reals_(is_host_
                       ? static_cast<std::uint32_t>(std::min<std::uint64_t>(most_bytes_of_host, device.local_bytes) /
                                                    real_bytes(precision))
                       : (columns_elsewhere + 2 * border_columns) * (rows_elsewhere + 2)),
      widest_(is_host_ ? local_reals_ / (fewest_rows + 2) / 16 * 16 - 2 * border_columns : columns_elsewhere) {}

Tiles::Shape Tiles::shape(const Grid &grid) const {
    const std::uint32_t across = quotient_up(grid.width, widest_);
    const std::uint32_t columns = quotient_up(quotient_up(grid.width, across), 16) * 16;
    const std::uint32_t most = local_reals() / (columns + 2 * border_columns) - 2;
    const std::uint32_t rows = is_host_ ? std::max(grid.height * across / fewest_tiles_, fewest_rows) : rows_elsewhere;
    return {columns, std::min(rows, most) / 2 * 2};
}

void Tiles::launch(Kernel &kernel, const Grid &grid, Planes planes) const {
    const Shape tile = shape(grid);
    grid.bind(kernel);
    kernel.set("first_channel", planes.first);
    kernel.set("tile_columns", tile.columns);
    kernel.set("tile_rows", tile.rows);
    kernel.set("lanes", lanes());
    launch_groups(kernel, std::size_t(quotient_up(grid.width, tile.columns)) * planes.count,
                  quotient_up(grid.height, tile.rows));
}

} // namespace gradus::solver
