// What solve() says of itself: residuals, objectives, counts, times.
#include "tests/solver/solver_fixture.h"

namespace gradus::testing {
namespace {

class Report : public ::testing::TestWithParam<LinearMethod> {};

TEST_P(Report, ResidualsAreTheTrueOnes) {
    const PoissonProblem problem = make_poisson_problem(129, 65, 3, 1);
    PoissonSolver &solver = solver_for(problem);
    for (const double tolerance : {1e-2, 1e-4}) {
        const Solution solution = solve(solver, problem.images(), l2_options(GetParam(), 0.2, tolerance));
        const PoissonReport &report = solution.report;
        EXPECT_TRUE(report.converged);
        ASSERT_EQ(report.residuals.size(), std::size_t(report.iterations) + 1);
        EXPECT_NEAR(report.residuals.front(), 1, 1e-5) << "at the primal";
        EXPECT_LE(report.residuals.back(), tolerance);
        // Recomputed in double from the image; that is in float, which costs 8 roundings of it.
        const double at_start = residual_norm(problem, 0.2, unit_weights(problem), to_double(problem.primal));
        const double slack = 8 * rounding * norm(to_double(solution.image)) / at_start;
        EXPECT_NEAR(relative_residual(problem, 0.2, unit_weights(problem), to_double(solution.image)),
                    report.residuals.back(), 0.01 * report.residuals.back() + slack);
        EXPECT_NEAR(report.objective / l2_objective(problem, 0.2, to_double(solution.image)), 1, 1e-5);
        EXPECT_EQ(report.alpha, 0.2);
        EXPECT_GT(report.seconds, 0);
        EXPECT_FALSE(report.kernels.empty());
        EXPECT_EQ(report.missing_primal + report.missing_dx + report.missing_dy + report.filled, 0u);
    }
}

/// Of one channel, since each channel must reach the tolerance by itself.
TEST_P(Report, StopsAtTheTolerance) {
    const PoissonProblem problem = make_poisson_problem(129, 65, 1, 1);
    const PoissonReport report = solve(problem, l2_options(GetParam(), 0.2, 1e-4)).report;
    // Other devices than the host are asked about cheap steps only now and then (solver/linear_solver.cpp).
    const bool steps_are_cheap = GetParam() == LinearMethod::jacobi || GetParam() == LinearMethod::cg;
    const std::size_t late = steps_are_cheap && !test_device().description().is_host ? 8 : 1;
    for (std::size_t k = 0; k + late < report.residuals.size(); ++k)
        EXPECT_GT(report.residuals[k], 1e-4) << "it should have stopped at step " << k;
}

/// Conjugate gradients decrease the error in the norm of A at each step, and with it the residual within
/// sqrt(condition number); the other methods decrease the residual itself.
TEST_P(Report, ResidualsDecrease) {
    const PoissonProblem problem = make_poisson_problem(129, 65, 3, 2);
    const std::vector<double> residuals = solve(problem, l2_options(GetParam(), 0.2, 1e-5)).report.residuals;
    const bool by_conjugate_gradients = GetParam() == LinearMethod::cg || GetParam() == LinearMethod::pcg;
    const double slack = by_conjugate_gradients ? std::sqrt(1 + 8 / 0.04) : 1;
    double least = residuals.front();
    for (const double residual : residuals) {
        EXPECT_LE(residual, least * slack);
        least = std::min(least, residual);
    }
    if (GetParam() == LinearMethod::cg) {
        const double root = std::sqrt(1 + 8 / 0.04), rate = (root - 1) / (root + 1);
        for (std::size_t k = 0; k < residuals.size(); ++k)
            EXPECT_LE(residuals[k], 2 * root * std::pow(rate, double(k))) << "the bound of conjugate gradients";
    }
}

TEST_P(Report, IterationsAreAtMostThoseAskedFor) {
    const PoissonProblem problem = make_poisson_problem(129, 65, 3, 3);
    PoissonSolver &solver = solver_for(problem);
    for (const int iterations : {1, 2, 5}) {
        PoissonOptions options = l2_options(GetParam(), 0.02, 1e-9);
        options.iterations = iterations;
        const Solution solution = solve(solver, problem.images(), options);
        EXPECT_EQ(solution.report.iterations, iterations);
        EXPECT_FALSE(solution.report.converged);
        EXPECT_EQ(solution.report.residuals.size(), std::size_t(iterations) + 1);
        const double at_start = residual_norm(problem, 0.02, unit_weights(problem), to_double(problem.primal));
        const double slack = 8 * rounding * norm(to_double(solution.image)) / at_start;
        EXPECT_NEAR(relative_residual(problem, 0.02, unit_weights(problem), to_double(solution.image)),
                    solution.report.residuals.back(), 0.01 * solution.report.residuals.back() + slack);
    }
}

/// More steps than fit into one record of residuals. Only Jacobi's method takes so many.
TEST(ReportJacobi, LongRunsAreReportedToo) {
    const PoissonProblem problem = make_poisson_problem(17, 9, 1, 4);
    PoissonOptions options = l2_options(LinearMethod::jacobi, 0.02, 1e-9);
    options.iterations = 10000;
    const Solution solution = solve(problem, options);
    EXPECT_EQ(solution.report.residuals.size(), std::size_t(solution.report.iterations) + 1);
    EXPECT_EQ(count_non_finite(solution.image), 0u);
    // The smoothest modes fall by 4 / (4 + alpha^2) a step.
    const double expected = std::exp(-10000 * std::log1p(0.02 * 0.02 / 4));
    EXPECT_LE(relative_error(solution.image, solve_directly(problem, 0.02)), 3 * expected);
}

INSTANTIATE_TEST_SUITE_P(Solver, Report, ::testing::ValuesIn(linear_methods), method_parameter_name);

TEST(ReportL1, ObjectivesAreTheTrueOnes) {
    const PoissonProblem problem = make_poisson_problem(129, 65, 3, 5);
    for (const bool joint : {true, false}) {
        PoissonOptions options = plain_l1_options();
        options.joint_channels = joint;
        const Solution solution = solve(problem, options);
        const PoissonReport &report = solution.report;
        EXPECT_GT(report.reweightings, 0);
        EXPECT_GE(report.iterations, report.reweightings);
        ASSERT_EQ(report.objectives.size(), std::size_t(report.reweightings) + 1);
        EXPECT_EQ(report.objective, report.objectives.back());
        EXPECT_NEAR(report.objective / l1_objective(problem, 0.2, to_double(solution.image), joint), 1, 1e-5);
        EXPECT_LT(report.objective, report.objectives.front());
        for (std::size_t k = 1; k < report.objectives.size(); ++k)
            EXPECT_LE(report.objectives[k], report.objectives[k - 1] * 1.01) << "reweighting " << k;
    }
}

TEST(ReportL1, StopsWhereTheNormHardlyFalls) {
    const PoissonProblem problem = make_poisson_problem(129, 65, 3, 5);
    PoissonOptions options = plain_l1_options();
    options.iterations = 200;
    const PoissonReport report = solve(problem, options).report;
    EXPECT_TRUE(report.converged);
    EXPECT_LT(report.reweightings, 40);
}

TEST(ReportL1, ReweightingsAreAtMostThoseAskedFor) {
    const PoissonProblem problem = make_poisson_problem(129, 65, 3, 6);
    PoissonOptions options = plain_l1_options();
    options.iterations = 3;
    options.tolerance = 1e-12;
    const PoissonReport report = solve(problem, options).report;
    EXPECT_EQ(report.reweightings, 3);
    EXPECT_FALSE(report.converged);
}

TEST(ReportL1, TheObjectiveIsThatBeforeTheCorrection) {
    const PoissonProblem problem = make_poisson_problem(96, 64, 3, 7);
    PoissonSolver &solver = solver_for(problem);
    const PoissonReport plain = solve(solver, problem.images(), plain_l1_options()).report;
    const PoissonReport corrected = solve(solver, problem.images(), PoissonOptions()).report;
    EXPECT_EQ(corrected.objective, plain.objective);
    EXPECT_EQ(corrected.correction.size(), 3u);
    EXPECT_TRUE(plain.correction.empty());
}

} // namespace
} // namespace gradus::testing
