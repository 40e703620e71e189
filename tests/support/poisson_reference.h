// Screened Poisson reconstruction on the host in double precision: what the solver is held against. Images are laid out
// as in solver/poisson_solver.h.
#pragma once

#include "tests/support/poisson_problem.h"

#include <vector>

namespace gradus::testing {

/// Factors of the squared residuals, by channel and pixel. Those of `primal` go with alpha^2. Edges that leave the
/// image and missing inputs have weight 0.
struct PoissonWeights {
    std::vector<double> primal, dx, dy;
};

/// 1 for each equation, 0 for a pixel of an input that is NaN or infinite in any channel.
PoissonWeights unit_weights(const PoissonProblem &problem);

/// The L2 solution with equal weights, direct by discrete cosine transform: in their basis the operator is diagonal,
/// with eigenvalues alpha^2 + 4 - 2 cos(pi i / W) - 2 cos(pi j / H). All inputs must be finite. With alpha = 0 the
/// solution whose means are those of the primal.
std::vector<double> solve_directly(const PoissonProblem &problem, double alpha);

/// Plain conjugate gradients for the weighted L2 problem, from `start`, channel by channel: at most `steps`, and until
/// the residual's norm is `tolerance` times the right side's. Missing inputs do not matter where their weight is 0.
std::vector<double> solve_weighted(const PoissonProblem &problem, double alpha, const PoissonWeights &weights,
                                   const std::vector<double> &start, int steps, double tolerance);

/// Sum of weight times squared residual, and of the residuals' absolute values, as in PoissonNorm; missing inputs are
/// left out.
double l2_objective(const PoissonProblem &problem, double alpha, const std::vector<double> &image);
double l1_objective(const PoissonProblem &problem, double alpha, const std::vector<double> &image, bool joint);

/// ||b - A u|| for u = image - primal, over all channels, and divided by ||b||: what the solver iterates on.
double residual_norm(const PoissonProblem &problem, double alpha, const PoissonWeights &weights,
                     const std::vector<double> &image);
double relative_residual(const PoissonProblem &problem, double alpha, const PoissonWeights &weights,
                         const std::vector<double> &image);

/// The L1 solution by iteratively reweighted least squares, as gradient-domain path tracers have used it since Kettunen
/// et al. 2015 but in double precision: the L2 solution first; then weights 1 / (|e| + reg), where |e| is over the
/// channels of a pixel if `joint` and reg starts at 0.05 of the mean |e| and halves each time; the inner systems by
/// `steps` of plain conjugate gradients from the last image. Returns the image with the least objective.
std::vector<double> solve_l1(const PoissonProblem &problem, double alpha, bool joint, int reweightings = 60,
                             int steps = 200);

/// Between which the least L1 objective lies, closer than solve_l1() comes to it, for small problems without missing
/// inputs. The upper number is an image's. The lower is by duality: any y with |y| <= 1 for each of the residuals
/// e = A I - b, and with A^T y = 0, gives sum |e| >= y . e = -y . b for every image.
struct Bracket {
    double least = 0, most = 0;
};
Bracket bracket_least_l1(const PoissonProblem &problem, double alpha, bool joint);

std::vector<double> to_double(const std::vector<float> &values);
std::vector<float> to_float(const std::vector<double> &values);

/// sqrt(sum (a - b)^2 / sum b^2) over all values.
double relative_error(const std::vector<float> &a, const std::vector<double> &b);
double relative_error(const std::vector<double> &a, const std::vector<double> &b);

} // namespace gradus::testing
