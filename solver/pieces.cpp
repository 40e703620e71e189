#include "solver/pieces.h"

#include "kernels/shared/solver_shared.h"

#include <numeric>
#include <vector>

namespace gradus::solver {

namespace {

/// Sets that grow together (Tarjan 1975), of pixels.
class DisjointSets {
  public:
    explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
    std::uint32_t root(std::uint32_t i) {
        for (; parent_[i] != i; i = parent_[i])
            parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::uint32_t a, std::uint32_t b) { parent_[root(b)] = root(a); }

  private:
    std::vector<std::uint32_t> parent_;
};

/// Calls visit(pixel, its place in a plane).
template <class Visit>
void for_each_pixel(const Grid &grid, const Visit &visit) {
    for (std::uint32_t y = 0; y < grid.height; ++y)
        for (std::uint32_t x = 0; x < grid.width; ++x)
            visit(y * grid.width + x, (std::size_t(y) + 1) * grid.row + SOLVER_MARGIN + x);
}

struct Sum {
    double values = 0, weights = 0;
    double mean() const { return weights > 0 ? values / weights : 0; }
};

/// Of one plane of weights, for `channels` planes of u from `u` on.
template <class Real>
void settle(const Grid &grid, const Real *weight_x, const Real *weight_y, const Real *weight_data, Real *u,
            std::uint32_t channels) {
    const std::size_t pixels = std::size_t(grid.width) * grid.height;
    DisjointSets pieces(pixels);
    for_each_pixel(grid, [&](std::uint32_t pixel, std::size_t at) { // beyond the last column and row weights are zero
        if (weight_x[at] > 0)
            pieces.join(pixel, pixel + 1);
        if (weight_y[at] > 0)
            pieces.join(pixel, pixel + grid.width);
    });
    for (std::uint32_t c = 0; c < channels; ++c, u += grid.plane) {
        std::vector<Sum> weighted(pixels), all(pixels); // by root
        for_each_pixel(grid, [&](std::uint32_t pixel, std::size_t at) {
            Sum &told = weighted[pieces.root(pixel)], &any = all[pieces.root(pixel)];
            told.values += double(weight_data[at]) * u[at];
            told.weights += weight_data[at];
            any.values += u[at];
            any.weights += 1;
        });
        for_each_pixel(grid, [&](std::uint32_t pixel, std::size_t at) {
            const std::uint32_t root = pieces.root(pixel);
            u[at] -= Real((weighted[root].weights > 0 ? weighted : all)[root].mean());
        });
    }
}

template <class Real>
void settle_all(const Kernels &kernels, Problem &problem, Workspace &workspace, const Buffer &data) {
    const Grid &grid = workspace.grid();
    const System &system = workspace.system();
    const Buffer::Mapping weight_x = system.weight_x.map(Access::read), weight_y = system.weight_y.map(Access::read);
    const Buffer::Mapping weight_data = data.map(Access::read), u = problem.u().map(Access::read_write);
    const std::uint32_t channels = workspace.channels / kernels.weight_planes; // that share a plane of weights
    for (std::uint32_t plane = 0; plane < kernels.weight_planes; ++plane) {
        const std::size_t first = std::size_t(plane) * grid.plane;
        settle(grid, weight_x.as<const Real>() + first, weight_y.as<const Real>() + first,
               weight_data.as<const Real>() + first, u.as<Real>() + first * channels, channels);
    }
}

} // namespace

void settle_means(const Kernels &kernels, Problem &problem, Workspace &workspace, const Buffer &data) {
    if (workspace.make.precision() == Precision::double_)
        settle_all<double>(kernels, problem, workspace, data);
    else
        settle_all<float>(kernels, problem, workspace, data);
}

} // namespace gradus::solver
