#include "solver/pieces.h"

#include "kernels/shared/solver_shared.h"

#include <numeric>

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
    std::uint32_t pixel = 0;
    for (std::uint32_t y = 0; y < grid.height; ++y) {
        const std::size_t line = (std::size_t(y) + 1) * grid.row + SOLVER_MARGIN;
        for (std::uint32_t x = 0; x < grid.width; ++x)
            visit(pixel++, line + x);
    }
}

/// Beyond the last column and row weights are zero.
template <class Real>
DisjointSets joined_pixels(const Grid &grid, const Real *weight_x, const Real *weight_y) {
    DisjointSets sets(std::size_t(grid.width) * grid.height);
    for_each_pixel(grid, [&](std::uint32_t pixel, std::size_t at) {
        if (weight_x[at] > 0)
            sets.join(pixel, pixel + 1);
        if (weight_y[at] > 0)
            sets.join(pixel, pixel + grid.width);
    });
    return sets;
}

/// Of one channel.
template <class Real>
void settle(const Grid &grid, const std::vector<std::uint32_t> &piece, std::size_t count, const Real *data, Real *u) {
    struct Sums {
        double told = 0, weights = 0, all = 0, pixels = 0;
        double mean() const { return weights > 0 ? told / weights : all / pixels; }
    };
    std::vector<Sums> of(count);
    for_each_pixel(grid, [&](std::uint32_t pixel, std::size_t at) {
        Sums &sums = of[piece[pixel]];
        sums.told += double(data[at]) * u[at];
        sums.weights += data[at];
        sums.all += u[at];
        ++sums.pixels;
    });
    for_each_pixel(grid, [&](std::uint32_t pixel, std::size_t at) { u[at] -= Real(of[piece[pixel]].mean()); });
}

/// Calls visit(a number of the solver's precision, zero).
template <class Visit>
void in_precision(Precision precision, const Visit &visit) {
    precision == Precision::double_ ? visit(double()) : visit(float());
}

} // namespace

Pieces::Pieces(Workspace &workspace) : workspace_(workspace) {
    const Grid &grid = workspace.grid();
    const System &system = workspace.system();
    const std::size_t planes = system.weight_plane > 0 ? workspace.channels : 1;
    in_precision(workspace.make.precision(), [&](auto real) {
        using Real = const decltype(real);
        const Buffer::Mapping weight_x = system.weight_x.map(Access::read),
                              weight_y = system.weight_y.map(Access::read);
        for (std::size_t i = 0; i < planes; ++i) {
            const std::size_t first = i * grid.plane;
            DisjointSets sets = joined_pixels(grid, weight_x.as<Real>() + first, weight_y.as<Real>() + first);
            Plane &plane = planes_.emplace_back();
            plane.piece.resize(std::size_t(grid.width) * grid.height);
            std::vector<std::uint32_t> number(plane.piece.size());
            for (std::uint32_t pixel = 0; pixel < number.size(); ++pixel)
                if (sets.root(pixel) == pixel)
                    number[pixel] = std::uint32_t(plane.count++);
            for (std::uint32_t pixel = 0; pixel < number.size(); ++pixel)
                plane.piece[pixel] = number[sets.root(pixel)];
        }
    });
}

void Pieces::settle_means(Problem &problem, const Buffer &data) const {
    const Grid &grid = workspace_.grid();
    const std::size_t channels = workspace_.channels / planes_.size(); // that share a plane of weights
    in_precision(workspace_.make.precision(), [&](auto real) {
        using Real = decltype(real);
        const Buffer::Mapping weights = data.map(Access::read), u = problem.u().map(Access::read_write);
        for (std::size_t c = 0; c < workspace_.channels; ++c) {
            const Plane &plane = planes_[c / channels];
            settle(grid, plane.piece, plane.count, weights.as<const Real>() + c / channels * grid.plane,
                   u.as<Real>() + c * grid.plane);
        }
    });
}

} // namespace gradus::solver
