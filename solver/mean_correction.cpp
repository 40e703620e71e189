#include "solver/mean_correction.h"

#include "kernels/shared/solver_shared.h"

#include <cmath>
#include <utility>

namespace gradus::solver {

namespace {

/// More takes more of the noise of I0, less leaves more of a local loss.
constexpr double smoothness = 0.25;
/// Of the first, second and third pass of the low-pass filter in its result: 3 H^2 - 2 H^3.
constexpr double shares[] = {0, 3, -2};
/// Of the mean of I, which has no outliers: darker pixels count as this bright.
constexpr double least_brightness = 1e-3;
/// Each divides the error by about ten, and this much less than the noise of I0 is enough.
constexpr int steps = 3;

} // namespace

MeanCorrection::MeanCorrection(Workspace &workspace)
    : workspace_(workspace), blocks_x_((workspace.grid().width - 1) / SOLVER_BLOCK + 1),
      blocks_y_((workspace.grid().height - 1) / SOLVER_BLOCK + 1),
      columns_((workspace.grid().width - 1) / SOLVER_TILE * SOLVER_TILE + SOLVER_TILE),
      largest_(workspace.make.reals("largest", std::size_t(3) * columns_ * blocks_y_)),
      bound_(workspace.make.reals("bound", std::size_t(blocks_x_) * blocks_y_)) {}

std::vector<double> MeanCorrection::add(Kernels &kernels, Problem &problem) {
    const Grid &grid = workspace_.grid();
    Sums &sums = workspace_.sums;
    const double pixels = double(grid.width) * grid.height;
    sums.sum_of(kernels, problem.base(), slot_sum);
    sums.sum_of(kernels, problem.u(), slot_second_sum);
    const double mean =
        std::abs(sums.read_total(slot_sum) + sums.read_total(slot_second_sum)) / (pixels * workspace_.channels);
    if (mean == 0)
        return std::vector<double>(workspace_.channels, 0);
    const double least = least_brightness * mean;
    const Buffer &all_right_sides = problem.gradient_x(), &correction = problem.gradient_y();
    Buffer &corrected = problem.spare();

    Kernel &columns = kernels.largest_of_columns;
    columns.set("columns", columns_);
    columns.bind("u", problem.u());
    columns.bind("valid", problem.valid_primal());
    columns.bind(largest_);
    grid.launch(columns, {0, 1}, blocks_y_);

    Kernel &third = kernels.third_largest;
    third.set("blocks_x", blocks_x_);
    third.set("blocks", blocks_x_ * blocks_y_);
    third.set("columns", columns_);
    third.bind(largest_);
    third.bind(bound_);
    third.launch(std::size_t(blocks_x_) * blocks_y_);

    Kernel &right_side = kernels.correction_right_side;
    right_side.set("blocks_x", blocks_x_);
    right_side.set_real("smoothness", smoothness);
    right_side.bind("u", problem.u());
    right_side.bind("valid", problem.valid_primal());
    right_side.bind(bound_);
    right_side.bind("right_side", all_right_sides);
    grid.launch(right_side, {0, 1});

    Kernel &weights = kernels.correction_weights;
    workspace_.system().bind(weights);
    weights.set_real("least", least);
    weights.set_real("smoothness", smoothness);
    weights.bind("base", problem.base());
    weights.bind("u", problem.u());
    weights.bind("valid", problem.valid_primal());
    grid.launch(weights, {0, kernels.weight_planes});
    workspace_.multigrid.coarsen_weights(kernels);

    LinearSolver::Request request;
    request.method = LinearMethod::pcg;
    request.iterations = steps;
    problem.gradient_y().clear();
    Buffer passed = problem.right_side(); // of a group, and not needed as such any more
    Kernel &pass = kernels.correction_pass;
    workspace_.system().bind(pass);
    pass.bind("passed", passed);
    pass.bind("correction", correction);
    pass.bind("right_side", all_right_sides);
    for (const Planes group : workspace_.groups()) {
        const Buffer of_group = workspace_.of_group(all_right_sides, group);
        for (const double share : shares) {
            passed.clear();
            workspace_.linear.improve(kernels, request, group, of_group, passed);
            pass.set_real("share", share);
            grid.launch(pass, group);
        }
    }

    Kernel &add = kernels.add_correction;
    add.set_real("least", least);
    add.bind("base", problem.base());
    add.bind("u", problem.u());
    add.bind("correction", correction);
    add.bind("corrected", corrected);
    grid.launch(add, {0, workspace_.channels});
    sums.sum_of(kernels, correction, slot_sum);
    std::swap(problem.u(), corrected);
    std::vector<double> means = sums.read(slot_sum);
    for (double &value : means)
        value /= pixels;
    return means;
}

} // namespace gradus::solver
