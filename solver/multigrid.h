// A hierarchy of grids and its cycle, which approximates the inverse of the operator.
//
// Each grid's pixels are 2 x 2 pixels of the finer one. Going down, each level smooths twice from zero, with Chebyshev
// steps over the upper three quarters of the spectrum of D^-1 A, [1/2, 2], and hands the sum of its residual over 2 x 2
// pixels to the next; going up, corrections are interpolated linearly, and two steps smooth again, in the other order.
// A cycle divides the residual of the five-point operator by more than ten, whatever the size and alpha (Trottenberg,
// Oosterlee and Schueller 2001, chapter 2). Coarse weights are sums of fine ones (see coarsen_weights), which keeps
// that rate at odd sizes and, inside conjugate gradients, where weights jump.
//
// A grid takes three launches: down and up again in tiles that stay in a cache (kernels/solver/cycle.cl), and the
// interpolation. The coarsest grids share one (kernels/solver/coarse_cycle.cl).
#pragma once

#include "solver/grid.h"
#include "solver/kernels.h"
#include "solver/sums.h"
#include "solver/tiles.h"

#include <functional>
#include <string>
#include <vector>

namespace gradus::solver {

/// The system A u = b on one grid: its weights as kernel arguments.
struct System {
    Grid grid;
    double data = 0; ///< uniform weights: that of the data term of a whole pixel
    Buffer column_left, column_right, column_size, row_up, row_down, row_size;
    Buffer weight_x, weight_y, weight_data; ///< other weights
    std::uint32_t weight_plane = 0;         ///< elements from a channel's weights to the next; 0 where all share one
    Buffer inverse_diagonal;

    /// Sets the weights.
    void bind(Kernel &kernel) const;
};

class Multigrid {
  public:
    /// For `together` channels at a time. Planes are made with the first weights.
    Multigrid(const PlaneMaker &make, std::uint32_t width, std::uint32_t height, std::uint32_t together);

    /// The finest system.
    System &system() { return levels_.front().system; }
    const System &system() const { return levels_.front().system; }
    const Tiles &tiles() const { return tiles_; }
    /// Where cycle() expects the right side, which it keeps.
    const Buffer &right_side() const { return levels_.front().right_side; }

    /// Makes all systems those of uniform weights: 1 for edges, `data` for the data term. Cycles then keep the mean.
    void set_uniform(Kernels &kernels, double data);
    /// Allocates the weights of all levels, `planes` of each.
    void allocate_weights(std::uint32_t planes);
    /// Makes the coarse systems after the weights of the finest one have been set.
    void coarsen_weights(Kernels &kernels);
    /// Makes the inverse diagonal of the finest system alone, for methods that need no hierarchy.
    void invert_finest_diagonal(Kernels &kernels);

    /// What conjugate gradients ask of a cycle's z: <z, right_side()> and <z, image>, each in a slot.
    struct Products {
        Sums &sums;
        const Buffer &image;
        std::uint32_t with_right_side, with_image;
    };
    /// Writes an approximate solution of A z = right_side() to solution(), for a group of channels, which all buffers
    /// hold alone. `smooths_after`: on the way up, too: twice the work, which few cycles for each set of weights do not
    /// pay back.
    void cycle(Kernels &kernels, Planes channels, bool smooths_after, const Products &products);
    const Buffer &solution() const { return levels_.front().smoothed; }
    /// Smooths on the way up, and adds z to `u` instead.
    void cycle_onto(Kernels &kernels, Planes channels, const Buffer &u);

  private:
    struct Level {
        System system;
        Buffer right_side;
        Buffer smoothed, other;
    };
    /// The planes of the coarsest levels, one level after the other; those levels have parts of them.
    struct Coarsest {
        std::uint32_t plane = 0; ///< elements of a plane of each level
        Buffer right_side, smoothed, other;
        Buffer weight_x, weight_y, weight_data, inverse_diagonal;
        std::uint32_t weight_planes = 0;
        Buffer levels; ///< a solver_level each
    };
    /// Makes planes for each of the coarsest levels within one buffer.
    void make_coarsest(Buffer &all, const std::string &name, std::uint32_t count,
                       const std::function<Buffer &(Level &)> &part);
    void allocate_weights_of_coarsest(std::uint32_t planes);
    void invert_diagonal(Kernels &kernels, System &system);
    void cycle_coarsest(Kernels &kernels, Planes channels);
    void go_down(Kernels &kernels, Planes channels);
    /// Interpolates the next coarser grid to this one.
    void prolong(Kernels &kernels, std::size_t level, Planes channels);
    /// `onto`, `products`: of the finest grid, or none.
    void smooth_again(Kernels &kernels, std::size_t level, Planes channels, const Buffer *onto,
                      const Products *products);
    void go_up(Kernels &kernels, Planes channels, bool smooths_after, const Buffer *onto, const Products *products);

    void allocate();

    const PlaneMaker make_;
    const std::uint32_t together_;
    const Tiles tiles_;
    std::vector<Level> levels_;
    std::size_t first_coarsest_ = 0; ///< of levels_; never the finest
    Coarsest coarsest_;
    std::size_t used_ = 0; ///< levels that the current weights need
};

} // namespace gradus::solver
