#include "solver/reweighting.h"

#include "solver/pieces.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numeric>
#include <optional>
#include <vector>

namespace gradus::solver {

namespace {

constexpr int default_reweightings = 20;
/// Of the scale.
constexpr double first_regularisation = 3, regularisation_factor = 0.5, least_regularisation = 1e-6, cut_at = 10;
/// How far a step is extrapolated: 1 is not at all. From the third reweighting on, when weights have settled.
constexpr double extrapolation = 1.8;
constexpr int first_extrapolated = 3;
/// The first step has the longest way, and weights that are nearly equal.
constexpr double first_tolerance = 1e-2;
constexpr int most_first_iterations = 20;
/// With a smaller alpha, a pixel that start_between_neighbours() moves is outweighed by those of its differences that
/// ask for it, which are three or four. With a larger one outliers of I0 may stay: from 4 on, all do.
constexpr double least_alpha_of_outliers = 3;

double total(const std::vector<double> &values, std::uint32_t planes) {
    return std::accumulate(values.begin(), values.begin() + planes, 0.0);
}

} // namespace

double Reweighting::scale_of(Kernels &kernels, Problem &problem) {
    Kernel &kernel = kernels.residual_scale;
    workspace_.system().bind(kernel);
    workspace_.sums.bind_parts(kernel, 2 * kernels.weight_planes);
    problem.bind(kernel);
    kernel.bind("u", problem.u());
    workspace_.grid().launch(kernel, {0, kernels.weight_planes});
    workspace_.sums.sum_two(kernels, slot_sum, slot_second_sum, {0, kernels.weight_planes});
    const double edges = total(workspace_.sums.read(slot_second_sum), kernels.weight_planes);
    return edges > 0 ? std::pow(total(workspace_.sums.read(slot_sum), kernels.weight_planes) / edges, 4) : 0;
}

Reweighting::Norm Reweighting::reweight(Kernels &kernels, Problem &problem, double alpha, double scale,
                                        double regularisation, double cut) {
    Kernel &kernel = kernels.reweight;
    workspace_.system().bind(kernel);
    workspace_.sums.bind_parts(kernel, 2 * kernels.weight_planes);
    problem.bind(kernel);
    kernel.set_real("alpha", alpha);
    kernel.set_real("scale", scale);
    kernel.set_real("regularisation", regularisation);
    kernel.set_real("cut", cut);
    kernel.bind("u", problem.u());
    workspace_.grid().launch(kernel, {0, kernels.weight_planes});
    workspace_.sums.sum_two(kernels, slot_sum, slot_second_sum, {0, kernels.weight_planes});
    return {total(workspace_.sums.read(slot_sum), kernels.weight_planes),
            total(workspace_.sums.read(slot_second_sum), kernels.weight_planes)};
}

void Reweighting::start(Kernels &kernels, Problem &problem, double alpha, const Inputs &images) {
    std::vector<std::function<void()>> starts = {[&] { problem.start_between_neighbours(kernels); }};
    if (alpha >= least_alpha_of_outliers)
        starts.insert(starts.begin(), [&] { problem.u().clear(); });
    if (images.start)
        starts.emplace_back([&] { problem.start(images); });
    if (starts.size() == 1)
        return starts[0]();
    // Reweighting hardly leaves a poor start, so the one of the least norm is taken.
    std::size_t best = 0;
    double least = 0;
    for (std::size_t i = 0; i < starts.size(); ++i) {
        starts[i]();
        const double norm = reweight(kernels, problem, alpha, 1, 1, 1).all;
        if (i == 0 || norm < least) {
            best = i;
            least = norm;
        }
    }
    if (best + 1 < starts.size())
        starts[best]();
}

void Reweighting::run(Kernels &kernels, Problem &problem, double alpha, const Inputs &images,
                      const PoissonOptions &options, PoissonReport &report) {
    const double tolerance = options.tolerance > 0 ? options.tolerance : 1e-4;
    const int most = options.iterations > 0 ? options.iterations : default_reweightings;
    LinearSolver::Request request;
    request.method = options.method == LinearMethod::automatic ? LinearMethod::pcg : options.method;
    request.damping = options.damping;

    const bool settles = alpha < least_alpha_of_means;
    std::optional<Pieces> pieces;
    start(kernels, problem, alpha, images);
    Buffer &previous = problem.spare();
    previous.clear();
    const double scale = scale_of(kernels, problem);
    double regularisation = first_regularisation * scale, before = 0;
    for (int k = 0;; ++k) {
        // Where no difference has a residual there is nothing to reweight by, and the start is the minimum (next to it
        // with an alpha of 3 to 4, of which some outliers of I0 stay and others do not). Weights of 1 stand in.
        const Norm norm = scale > 0 ? reweight(kernels, problem, alpha, scale, regularisation, cut_at * scale)
                                    : reweight(kernels, problem, alpha, 1, 1, 1);
        report.objectives.push_back(norm.all);
        report.converged = scale == 0 || (k > 1 && std::abs(before - norm.cut) <= tolerance * norm.cut);
        if (report.converged || k == most) {
            if (k == 0) // no solve did it, and it tells which pixels no equation holds
                workspace_.multigrid.invert_finest_diagonal(kernels);
            break;
        }
        before = norm.cut;
        workspace_.multigrid.coarsen_weights(kernels);
        Kernel &extrapolate = kernels.extrapolate;
        extrapolate.set_real("factor", k >= first_extrapolated ? extrapolation - 1 : 0);
        extrapolate.bind("u", problem.u());
        extrapolate.bind("previous", previous);
        workspace_.grid().launch(extrapolate, {0, workspace_.channels});
        request.watch = k == 0;
        request.tolerance = first_tolerance;
        request.iterations = k == 0 ? most_first_iterations : options.inner_iterations;
        const auto right_side = [&](Planes group) -> const Buffer & { return problem.make_right_side(kernels, group); };
        report.iterations +=
            workspace_.linear.solve(kernels, request, workspace_.groups(), right_side, problem.u()).iterations;
        if (settles) {
            if (!pieces) // which weights that differ from 0 make, whatever they are
                pieces.emplace(workspace_);
            pieces->settle_means(problem, alpha > 0 ? workspace_.system().weight_data : problem.base_data());
        }
        ++report.reweightings;
        regularisation = std::max(regularisation * regularisation_factor, least_regularisation * scale);
    }
    report.objective = report.objectives.back();
}

} // namespace gradus::solver
