#include "solver/grid.h"

#include "kernels/shared/solver_shared.h"
#include "runtime/error.h"

#include <fmt/format.h>

#include <limits>

namespace gradus::solver {

namespace {

std::uint32_t tiles(std::uint32_t width) { return quotient_up(width, SOLVER_TILE); }

} // namespace

Grid::Grid(std::uint32_t width, std::uint32_t height) : width(width), height(height) {
    const std::uint64_t row_elements = std::uint64_t(tiles(width)) * SOLVER_TILE + SOLVER_MARGIN;
    // A row above, a row below, and the margin that ends the last row; rounded up to what sums over planes take.
    constexpr std::uint64_t unit = SOLVER_REDUCTION * SOLVER_TILE;
    const std::uint64_t plane_elements =
        ((std::uint64_t(height) + 2) * row_elements + SOLVER_MARGIN + unit - 1) / unit * unit;
    // Kernels count elements of all channels (8 at most) in 32 bits.
    if (plane_elements * 8 > std::numeric_limits<std::uint32_t>::max())
        throw Error(ExitCode::device, fmt::format("an image of {} x {} pixels is too large for the solver, which takes "
                                                  "up to about 500 million",
                                                  width, height));
    row = static_cast<std::uint32_t>(row_elements);
    plane = static_cast<std::uint32_t>(plane_elements);
}

std::uint32_t Grid::partials() const { return tiles(width) * SOLVER_TILE * height; }

void Grid::bind(Kernel &kernel) const {
    kernel.set("width", width);
    kernel.set("height", height);
    kernel.set("row", row);
    kernel.set("plane", plane);
}

void Grid::launch(Kernel &kernel, Planes planes, std::uint32_t rows, std::uint32_t first_row) const {
    bind(kernel);
    kernel.set("first_channel", planes.first);
    kernel.set("first_row", first_row);
    launch_groups(kernel, std::size_t(tiles(width)) * planes.count, rows > 0 ? rows : height);
}

Buffer PlaneMaker::planes(const std::string &name, const Grid &grid, std::uint32_t count) const {
    return reals(name, std::size_t(grid.plane) * count);
}

Buffer PlaneMaker::some(const Buffer &all, const Grid &grid, Planes planes) const {
    const std::size_t plane = grid.plane * real_bytes(precision_);
    return planes.count * plane == all.bytes() ? all : all.part(planes.first * plane, planes.count * plane);
}

Buffer PlaneMaker::reals(const std::string &name, std::size_t count) const {
    Buffer buffer(device_, name, count * real_bytes(precision_));
    buffer.clear();
    return buffer;
}

Buffer PlaneMaker::reals(const std::string &name, const std::vector<double> &values) const {
    if (precision_ == Precision::double_)
        return Buffer(device_, name, values.data(), values.size() * sizeof(double));
    const std::vector<float> single(values.begin(), values.end());
    return Buffer(device_, name, single.data(), single.size() * sizeof(float));
}

void launch_groups(Kernel &kernel, std::size_t groups, std::size_t lines) {
    kernel.launch(groups * SOLVER_TILE, lines);
}

} // namespace gradus::solver
