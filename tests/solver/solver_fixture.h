// The device under test, solving in one line, and how exact single precision can be.
#pragma once

#include "runtime/device/program.h"
#include "solver/poisson_solver.h"
#include "tests/support/poisson_reference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

namespace gradus {

// What messages call parameters.
inline void PrintTo(LinearMethod method, std::ostream *out) { *out << method_name(method); }
inline void PrintTo(PoissonNorm norm, std::ostream *out) { *out << (norm == PoissonNorm::l1 ? "L1" : "L2"); }
inline void PrintTo(const PoissonOptions &options, std::ostream *out) {
    PrintTo(options.norm, out);
    *out << ", " << method_name(options.method);
}

} // namespace gradus

namespace gradus::testing {

/// Half the distance from 1 to the next float: the relative error of one rounding.
constexpr double rounding = 0.5 * double(std::numeric_limits<float>::epsilon());

/// The device that all tests of a process share. GRADUS_TEST_DEVICE selects another than the default one.
inline Device &test_device() {
    const char *selector = std::getenv("GRADUS_TEST_DEVICE");
    static Device device(selector ? selector : "");
    static const std::shared_ptr<void> compilers = keep_compilers(device); // many solvers, each with some new kernels
    return device;
}

struct Solution {
    std::vector<float> image;
    PoissonReport report;
};

inline Solution solve(PoissonSolver &solver, const HostImages &images, const PoissonOptions &options) {
    Solution solution;
    solution.image.assign(std::size_t(solver.width()) * solver.height() * solver.channels(), -1e30f);
    solution.report = solver.solve(images, options, solution.image.data());
    return solution;
}

/// The solver for a problem's size; made once a process, for its kernels take a second.
inline PoissonSolver &solver_for(const PoissonProblem &problem) {
    Device &device = test_device(); // first, so that the solvers go before it
    static std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, std::unique_ptr<PoissonSolver>> solvers;
    std::unique_ptr<PoissonSolver> &solver = solvers[{problem.width, problem.height, problem.channels}];
    if (!solver)
        solver = std::make_unique<PoissonSolver>(device, problem.width, problem.height, problem.channels);
    return *solver;
}

inline Solution solve(const PoissonProblem &problem, const PoissonOptions &options) {
    return solve(solver_for(problem), problem.images(), options);
}

inline PoissonOptions l2_options(LinearMethod method, double alpha = 0.2, double tolerance = 0) {
    PoissonOptions options;
    options.norm = PoissonNorm::l2;
    options.method = method;
    options.alpha = alpha;
    options.tolerance = tolerance;
    return options;
}

/// L1 as the objective defines it, without the correction of the mean.
inline PoissonOptions plain_l1_options(double alpha = 0.2) {
    PoissonOptions options;
    options.alpha = alpha;
    options.keep_mean = false;
    return options;
}

constexpr LinearMethod linear_methods[] = {LinearMethod::automatic, LinearMethod::jacobi, LinearMethod::cg,
                                           LinearMethod::pcg, LinearMethod::multigrid};

/// For the names of parameterised tests.
inline std::string method_parameter_name(const ::testing::TestParamInfo<LinearMethod> &info) {
    return method_name(info.param);
}

inline double norm(const std::vector<double> &values) {
    double squares = 0;
    for (const double value : values)
        squares += value * value;
    return std::sqrt(squares);
}

/// The relative error that rounding leaves in the L2 solution, whatever the method. A residual b - A u in float is off
/// by about one rounding of (alpha^2 + 8) |u| at each pixel, and the error by A^-1 times that. In the worst case, where
/// all roundings conspire in the smoothest mode, that is the condition number 1 + 8 / alpha^2 times one rounding of u.
/// Roundings are independent, though, so all modes get equal shares, and the root mean square of 1 / eigenvalue counts
/// instead of the largest: 0.28 / alpha instead of 1 / alpha^2 in a large image. To this comes the rounding of
/// I = I0 + u. A factor of 4 covers the few operations that a residual takes.
inline double float_floor(const PoissonProblem &problem, double alpha, const std::vector<double> &solution) {
    double squares = 0;
    for (std::uint32_t j = 0; j < problem.height; ++j)
        for (std::uint32_t i = 0; i < problem.width; ++i) {
            const double eigenvalue = alpha * alpha + 4 - 2 * std::cos(std::numbers::pi * i / problem.width) -
                                      2 * std::cos(std::numbers::pi * j / problem.height);
            squares += alpha > 0 || i + j > 0 ? 1 / (eigenvalue * eigenvalue) : 0;
        }
    const double amplification = std::sqrt(squares / double(problem.pixels()));
    std::vector<double> u = solution;
    for (std::size_t i = 0; i < u.size(); ++i)
        u[i] -= problem.primal[i];
    return 4 * rounding * ((alpha * alpha + 8) * amplification * norm(u) / norm(solution) + 1);
}

/// Enough steps of a method for the error to fall by `factor`, from the classical bounds; cycles of multigrid gain at
/// least a factor of 3.
inline int enough_steps(LinearMethod method, double alpha, double factor) {
    const double condition = 1 + 8 / (alpha * alpha);
    switch (method) {
    case LinearMethod::jacobi: // spectral radius at most 4 / (4 + alpha^2)
        return int(std::ceil(std::log(factor) / std::log1p(alpha * alpha / 4)));
    case LinearMethod::cg:
        return int(std::ceil(0.5 * std::sqrt(condition) * std::log(2 * std::sqrt(condition) * factor)));
    default:
        return int(std::ceil(std::log(factor) / std::log(3.0)));
    }
}

inline std::vector<double> means(const std::vector<float> &image, std::uint32_t channels) {
    std::vector<double> result;
    const std::size_t pixels = image.size() / channels;
    for (std::uint32_t c = 0; c < channels; ++c) {
        double sum = 0;
        for (std::size_t i = 0; i < pixels; ++i)
            sum += image[c * pixels + i];
        result.push_back(sum / double(pixels));
    }
    return result;
}

inline std::size_t count_non_finite(const std::vector<float> &values) {
    std::size_t count = 0;
    for (const float value : values)
        count += !std::isfinite(value);
    return count;
}

} // namespace gradus::testing
