// The means of an image's pieces, where the data term is lost in rounding beside the differences.
#pragma once

#include "solver/problem.h"

#include <vector>

namespace gradus::solver {

/// With a smaller alpha the data terms hardly tell the mean of a solution from rounding errors.
inline constexpr double least_alpha_of_means = 1e-2;

/// What a smaller alpha of the L2 norm, but for 0, counts as: the solution is hardly another one, while coarse grids
/// would take rounding errors for means so large that its digits are lost to them.
inline constexpr double least_alpha_of_squares = 1e-4;

/// The pieces of an image: pixels that differences join. On the host: such settings are rare, and pieces have any
/// shape.
class Pieces {
  public:
    /// Those that the weights of the finest system make.
    explicit Pieces(Workspace &workspace);

    /// Sets the mean of u to zero in each piece, as the equations have it: those of a piece add up to sum w u = 0, w
    /// being the weights of its data terms. `data`: these weights, or what they are the same share of everywhere. Of a
    /// piece whose data are all missing, the mean over its pixels.
    void settle_means(Problem &problem, const Buffer &data) const;

  private:
    struct Plane {
        std::vector<std::uint32_t> piece; ///< by pixel
        std::size_t count = 0;
    };
    Workspace &workspace_;
    std::vector<Plane> planes_; ///< by plane of weights
};

} // namespace gradus::solver
