// Images of 8 Mpixel: sums of so many floats must not end the iteration early.
#include "tests/solver/solver_fixture.h"

#include <numeric>

namespace gradus::testing {
namespace {

/// alpha is small, so that the solution is smooth over many pixels and the residual needs many steps.
TEST(FullLarge, ConjugateGradientsDoNotStagnate) {
    const PoissonProblem problem = make_poisson_problem(3840, 2160, 1, 1);
    for (const double alpha : {0.2, 0.05}) {
        PoissonOptions options = l2_options(LinearMethod::cg, alpha, 1e-5);
        const Solution solution = solve(problem, options);
        const double residual = relative_residual(problem, alpha, unit_weights(problem), to_double(solution.image));
        std::printf("alpha %g: %d steps, relative residual %.2e, in double %.2e\n", alpha, solution.report.iterations,
                    solution.report.residuals.back(), residual);
        EXPECT_TRUE(solution.report.converged);
        EXPECT_LE(solution.report.iterations, enough_steps(LinearMethod::cg, alpha, 1e5));
        // The image is in float: 8 roundings of it, relative to the right side, which is about as large.
        EXPECT_LE(residual, 1e-5 + 8 * rounding);
    }
}

TEST(FullLarge, SolutionsAreThoseOfTheReference) {
    const PoissonProblem problem = make_poisson_problem(4096, 2160, 1, 2);
    const std::vector<double> reference = solve_directly(problem, 0.2);
    // The residual is at most the default tolerance of the first one, which starts from the primal. No eigenvalue is
    // below alpha^2, so the error is at most the residual over it.
    const double first = residual_norm(problem, 0.2, unit_weights(problem), to_double(problem.primal));
    const double norm = std::sqrt(std::inner_product(reference.begin(), reference.end(), reference.begin(), 0.0));
    const double promised = 1e-5 * first / (0.2 * 0.2) / norm;
    PoissonSolver &solver = solver_for(problem);
    for (const LinearMethod method : {LinearMethod::cg, LinearMethod::pcg, LinearMethod::multigrid}) {
        const Solution solution = solve(solver, problem.images(), l2_options(method));
        const double error = relative_error(solution.image, reference);
        std::printf("%s: relative error %.2e, promised %.2e, after %d steps\n", method_name(method), error, promised,
                    solution.report.iterations);
        EXPECT_LE(error, promised) << method_name(method);
        EXPECT_TRUE(solution.report.converged);
        EXPECT_NEAR(means(solution.image, 1)[0] / means(problem.primal, 1)[0], 1, 1e-6) << method_name(method);
    }
    const double floor = float_floor(problem, 0.2, reference);
    PoissonOptions options = l2_options(LinearMethod::multigrid, 0.2, 1e-9);
    options.iterations = 20;
    EXPECT_LE(relative_error(solve(solver, problem.images(), options).image, reference), floor);
}

} // namespace
} // namespace gradus::testing
