#include "methods/photons/photon_map.h"

#include "kernels/shared/scene_records.h"
#include "kernels/shared/tables.h"

#include <algorithm>
#include <cmath>

namespace gradus {

using namespace lib_float;

namespace {

// Keys that photons are sorted by. More would not fit into the cache with all else.
constexpr std::uint32_t key_bits = 21, most_keys = 1u << key_bits;
// What there is room for at first: most grids have fewer than a million keys, small renders a few hundred.
constexpr std::uint32_t first_keys = 1u << 12;
// Cells along an axis: so many single precision tells apart. And lines of cells, which have numbers of 32 bits.
constexpr double most_cells = 1 << 20, most_lines = 0x1p31;
// Positions are computed, and are off by some units in the last place of the largest coordinate.
constexpr double rounding = 0x1p-20;

constexpr const char *grown_uints[] = {"photon_key", "photon_line_of", "photon_line_sorted"};

/// Calls set_real and set_number with the name and value of each argument that is the grid's.
template <class SetReal, class SetNumber>
void set_grid(const PhotonGrid &grid, const SetReal &set_real, const SetNumber &set_number) {
    for (int axis = 0; axis < 3; ++axis) {
        const std::string name(1, char('x' + axis));
        set_real("grid_low_" + name, grid.low[axis]);
        set_number("grid_last_" + name, grid.last[axis]);
    }
    set_real("grid_inverse_edge", grid.inverse_edge);
    set_real("grid_reach", grid.reach);
    set_number("line_stride", grid.line_stride);
    set_number("line_shift", grid.line_shift);
}

StageDeclaration cells_stage(const char *entry, std::vector<std::string> numbers) {
    return {.name = entry, .file = "photon_cells", .entry = entry, .strict = true, .numbers = std::move(numbers)};
}

} // namespace

PhotonGrid::PhotonGrid(const Bounds &box, double edge, std::uint32_t most) : low(box.lower) {
    double farthest = 0;
    for (int axis = 0; axis < 3; ++axis)
        farthest = std::max({farthest, std::fabs(box.lower[axis]), std::fabs(box.upper[axis])});
    const double height = box.upper[1] - box.lower[1], depth = box.upper[2] - box.lower[2];
    edge = std::max({edge, box.extent() / (most_cells - 1), std::sqrt(height * depth / most_lines), 1e-30});
    inverse_edge = 1 / edge;
    reach = farthest * rounding;
    std::uint64_t cells = 1;
    for (int axis = 0; axis < 3; ++axis) {
        last[axis] = static_cast<std::uint32_t>((box.upper[axis] - box.lower[axis]) * inverse_edge);
        cells *= last[axis] + 1;
    }
    if (cells <= most) {
        line_stride = last[0] + 1;
        line_shift = 0;
        keys = static_cast<std::uint32_t>(cells);
    } else { // Fibonacci hashing (Knuth 1998, 6.4), to half of the keys
        std::uint32_t bits = 0;
        while ((2ull << bits) <= most / 2)
            ++bits;
        line_stride = 0x9E3779B1u;
        line_shift = 32 - bits;
        keys = (1u << bits) + last[0];
    }
}

PhotonMap::PhotonMap(Session &session, Stages &stages, std::uint32_t rows)
    : stages_(stages), box_(session.scene.bounds), rows_(rows),
      columns_(session.has("TRAIT_LIGHT_VERTICES") ? photon_columns : photon_before),
      sort_(session, stages, "photon_sort", RowsOf::one, rows), cells_(stages.add(cells_stage("photon_cells", {}))),
      copy_(stages.add(cells_stage("photon_copy", {}))), lines_(stages.add(cells_stage("photon_lines", {}))),
      starts_(stages.add(cells_stage("photon_starts", {"photons", "keys"}))) {
    session.numbers["photons_sorted"] = 0; // build() says it, and the grid
    set_grid(
        PhotonGrid(box_, 1, most_keys), [&](const std::string &name, double value) { session.reals[name] = value; },
        [&](const std::string &name, std::uint32_t value) { session.numbers[name] = value; });
}

TableList PhotonMap::tables() const {
    TableList list = sort_.tables();
    list.push_back(
        {.name = "photon_sorted", .rows = RowsOf::one, .multiple = rows_, .columns = columns_, .grows = true});
    for (const char *name : grown_uints)
        list.push_back({.name = name, .rows = RowsOf::one, .multiple = rows_, .is_uint = true, .grows = true});
    list.push_back(
        {.name = "photon_first", .rows = RowsOf::one, .multiple = first_keys + 1, .is_uint = true, .grows = true});
    return list;
}

void PhotonMap::attach(Tables &tables) {
    tables_ = &tables;
    sort_.attach(tables);
}

void PhotonMap::grow() {
    const auto rows = static_cast<std::uint32_t>(tables_->rows_of("photon"));
    if (rows == rows_)
        return;
    sort_.grow(rows);
    tables_->grow("photon_sorted", rows);
    for (const char *name : grown_uints)
        tables_->grow(name, rows);
    rows_ = rows;
}

void PhotonMap::build(std::uint32_t rows, std::uint32_t count, double edge) {
    grow();
    const PhotonGrid grid(box_, edge, most_keys);
    if (const std::uint64_t room = tables_->rows_of("photon_first"); grid.keys >= room)
        tables_->grow("photon_first", std::max<std::uint32_t>(grid.keys, 2 * room) + 1);
    set_grid(
        grid, [&](const std::string &name, double value) { stages_.set_real(name, value); },
        [&](const std::string &name, std::uint32_t value) { stages_.set(name, value); });
    stages_.set("photons_sorted", count);
    cells_.run(rows);
    sort_.run_in((*tables_)["photon_order"], (*tables_)["photon_key"], count, grid.keys - 1);
    copy_.run_planes(0, count, columns_);
    lines_.run(count);
    starts_.run(count + 1, {{"photons", count}, {"keys", grid.keys}});
}

} // namespace gradus
