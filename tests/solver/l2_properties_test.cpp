// What the L2 solution must obey whatever the inputs: exactness, the mean, linearity, scale, limits of alpha.
#include "tests/solver/solver_fixture.h"
#include "tests/support/stability.h"
#include "tests/support/worse.h"

#include <random>

namespace gradus::testing {
namespace {

class L2Properties : public ::testing::TestWithParam<LinearMethod> {
  protected:
    LinearMethod method() const { return GetParam(); }
};

constexpr std::uint32_t sizes[][2] = {{129, 65}, {1, 301}, {301, 1}, {1, 1}};

TEST_P(L2Properties, ExactInputsComeBackFromAZeroStart) {
    for (const auto &[width, height] : sizes) {
        const PoissonProblem problem = make_exact_problem(width, height, 3);
        const std::vector<float> zeros(problem.primal.size());
        HostImages images = problem.images();
        images.start = zeros.data();
        PoissonSolver &solver = solver_for(problem);
        const Solution solution = solve(solver, images, l2_options(method()));
        EXPECT_LE(relative_error(solution.image, to_double(problem.clean)), 1e-6) << width << " x " << height;
        EXPECT_TRUE(solution.report.converged) << width << " x " << height;
    }
}

TEST_P(L2Properties, TheStartDoesNotDecideTheSolution) {
    const PoissonProblem problem = make_poisson_problem(129, 65, 3, 1);
    const std::vector<double> reference = solve_directly(problem, 0.2);
    PoissonSolver &solver = solver_for(problem);
    std::vector<float> start(problem.primal.size());
    std::mt19937_64 random(2);
    std::uniform_real_distribution<float> uniform(-10, 10);
    for (float &value : start)
        value = uniform(random);
    HostImages images = problem.images();
    images.start = start.data();
    const Solution far = solve(solver, images, l2_options(method(), 0.2, 1e-6));
    EXPECT_LE(relative_error(far.image, reference), 1e-4);
    EXPECT_TRUE(far.report.converged);
    // From the solution there is nothing left to do.
    images.start = far.image.data();
    const Solution again = solve(solver, images, l2_options(method(), 0.2, 1e-5));
    EXPECT_EQ(again.report.iterations, 0);
    EXPECT_LE(relative_error(again.image, to_double(far.image)), 4 * rounding);
}

TEST_P(L2Properties, TheMeanOfThePrimalIsKept) {
    double worst = 0;
    for (const double tolerance : {1e-2, 1e-5})
        for (const auto &[width, height] : sizes) {
            const PoissonProblem problem = make_poisson_problem(width, height, 3, 3);
            const Solution solution = solve(problem, l2_options(method(), 0.2, tolerance));
            const std::vector<double> expected = means(problem.primal, 3), kept = means(solution.image, 3);
            for (std::size_t c = 0; c < 3; ++c)
                worst = worse(worst, std::abs(kept[c] / expected[c] - 1));
        }
    record_stability({"Reconstruction", "energy: an unfinished iteration has another mean than the primal",
                      "tolerances of 1e-2 and 1e-5, L2, every method",
                      "solves for what is to be added, whose mean is 0", "relative error of the mean", worst, 1e-6});
}

TEST_P(L2Properties, SolutionsAddUp) {
    PoissonProblem a = make_poisson_problem(51, 37, 3, 4), b = make_poisson_problem(51, 37, 3, 5);
    // Multiples of a small power of two, so that the sum of the inputs is exact.
    for (PoissonProblem *problem : {&a, &b})
        for (std::vector<float> *plane : {&problem->primal, &problem->dx, &problem->dy})
            for (float &value : *plane)
                value = std::round(value * 4096) / 4096;
    PoissonProblem sum = a;
    for (std::size_t i = 0; i < sum.primal.size(); ++i) {
        sum.primal[i] = a.primal[i] - 3 * b.primal[i];
        sum.dx[i] = a.dx[i] - 3 * b.dx[i];
        sum.dy[i] = a.dy[i] - 3 * b.dy[i];
    }
    const PoissonOptions options = l2_options(method(), 0.2, 1e-6);
    const Solution of_a = solve(a, options), of_b = solve(b, options), of_sum = solve(sum, options);
    std::vector<double> expected = to_double(of_a.image);
    for (std::size_t i = 0; i < expected.size(); ++i)
        expected[i] -= 3 * double(of_b.image[i]);
    // Three solutions, each as near to the true one as |residual| / alpha^2, at worst.
    EXPECT_LE(relative_error(of_sum.image, expected), 3 * 1e-6 * 9 / (0.2 * 0.2));
}

/// Floating point scales by powers of two without rounding, so a solver without constants that have a unit gives the
/// very same bits. Not so where squares of residuals underflow.
TEST_P(L2Properties, ScaleDoesNotMatter) {
    const PoissonProblem problem = make_poisson_problem(51, 37, 3, 6);
    const Solution expected = solve(problem, l2_options(method()));
    for (const int exponent : {-30, -15, 15, 30}) {
        PoissonProblem scaled = problem;
        for (std::vector<float> *plane : {&scaled.primal, &scaled.dx, &scaled.dy})
            for (float &value : *plane)
                value = std::ldexp(value, exponent);
        Solution solution = solve(scaled, l2_options(method()));
        for (float &value : solution.image)
            value = std::ldexp(value, -exponent);
        EXPECT_EQ(solution.image, expected.image) << "times 2^" << exponent;
        EXPECT_EQ(solution.report.iterations, expected.report.iterations);
    }
}

TEST_P(L2Properties, LargeAlphaGivesThePrimal) {
    const PoissonProblem problem = make_poisson_problem(75, 43, 3, 7);
    const double noise = relative_error(problem.primal, solve_directly(problem, 0.2));
    double worst = 0;
    for (const double alpha : {1e2, 1e4, 1e8, 1e15, 1e30}) {
        const Solution solution = solve(problem, l2_options(method(), alpha));
        EXPECT_EQ(count_non_finite(solution.image), 0u) << alpha;
        // |u| <= |b| / alpha^2, and |b| <= 8 |noise|.
        worst = worse(worst, relative_error(solution.image, to_double(problem.primal)) /
                                 (2 * 8 * (1 + noise) / (alpha * alpha) + rounding));
        EXPECT_LE(relative_error(solution.image, solve_directly(problem, alpha)), 1e-5) << alpha;
    }
    record_stability({"Reconstruction", "alpha to infinity: squares overflow",
                      "alpha from 100 to 1e30, L2, every method", "returns the primal",
                      "distance from the primal over its bound 16 (1 + noise) / alpha^2", worst, 1});
}

/// With alpha = 0 the differences decide all but the mean. Jacobi's method needs damping there, for the checkerboard.
TEST_P(L2Properties, SmallAlphaTendsToTheSolutionOfAlphaZero) {
    const PoissonProblem problem = make_poisson_problem(24, 17, 3, 8);
    const std::vector<double> limit = solve_directly(problem, 0);
    double worst = 0;
    PoissonSolver &solver = solver_for(problem);
    for (const double alpha : {1e-3, 1e-6, 1e-12, 1e-30, 0.0}) {
        PoissonOptions options = l2_options(method(), alpha, 1e-6);
        options.damping = method() == LinearMethod::jacobi ? 0.8 : 1.0;
        const Solution solution = solve(solver, problem.images(), options);
        // The smoothest mode's eigenvalue is (pi / 24)^2; a solution strays from the limit by alpha^2 over it.
        const double smoothest = std::pow(std::numbers::pi / 24, 2);
        worst = worse(worst,
                      relative_error(solution.image, limit) / (2 * alpha * alpha / smoothest + 9 * 1e-6 / smoothest));
        const std::vector<double> expected = means(problem.primal, 3), kept = means(solution.image, 3);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(kept[c] / expected[c], 1, 1e-6) << "alpha " << alpha;
        EXPECT_TRUE(solution.report.converged) << "alpha " << alpha;
    }
    record_stability({"Reconstruction", "alpha to 0: the system is singular", "alpha from 1e-3 to 0, L2, every method",
                      "tends to the solution of alpha 0, whose mean is the primal's",
                      "distance from the solution of alpha 0 in double, over what alpha and tolerance allow", worst,
                      1});
}

TEST_P(L2Properties, DirectLightIsAddedAsItIs) {
    const PoissonProblem problem = make_poisson_problem(75, 43, 3, 9);
    PoissonSolver &solver = solver_for(problem);
    const Solution without = solve(solver, problem.images(), l2_options(method()));
    std::vector<float> direct(problem.primal.size());
    direct[7] = 100;
    direct.back() = 1e6f;
    HostImages images = problem.images();
    images.direct = direct.data();
    const Solution with = solve(solver, images, l2_options(method()));
    for (std::size_t i = 0; i < direct.size(); ++i)
        ASSERT_EQ(with.image[i], without.image[i] + direct[i]) << i;
}

TEST_P(L2Properties, TheLastColumnAndRowOfDifferencesAreNotRead) {
    PoissonProblem problem = make_poisson_problem(75, 43, 3, 10);
    PoissonSolver &solver = solver_for(problem);
    const Solution expected = solve(solver, problem.images(), l2_options(method()));
    for (const float poison : {1e20f, std::numeric_limits<float>::quiet_NaN()}) {
        for (std::uint32_t c = 0; c < 3; ++c) {
            for (std::uint32_t y = 0; y < 43; ++y)
                problem.dx[problem.at(c, 74, y)] = poison;
            for (std::uint32_t x = 0; x < 75; ++x)
                problem.dy[problem.at(c, x, 42)] = poison;
        }
        const Solution solution = solve(solver, problem.images(), l2_options(method()));
        EXPECT_EQ(solution.image, expected.image);
        EXPECT_EQ(solution.report.missing_dx + solution.report.missing_dy, 0u);
    }
}

INSTANTIATE_TEST_SUITE_P(Solver, L2Properties, ::testing::ValuesIn(linear_methods), method_parameter_name);

/// Kernels in double leave only the rounding of the result to float.
TEST(L2Precision, DoubleIsExactToTheFloatThatItReturns) {
    if (!test_device().description().has_double)
        GTEST_SKIP() << test_device().description().name << " has no double precision";
    const PoissonProblem problem = make_poisson_problem(129, 65, 3, 11);
    PoissonSolver solver(test_device(), problem.width, problem.height, problem.channels, Precision::double_);
    for (const double alpha : {0.02, 0.2})
        for (const LinearMethod method : {LinearMethod::cg, LinearMethod::pcg, LinearMethod::multigrid}) {
            PoissonOptions options = l2_options(method, alpha, 1e-12);
            options.iterations = enough_steps(method, alpha, 1e12);
            const Solution solution = solve(solver, problem.images(), options);
            EXPECT_LE(relative_error(solution.image, solve_directly(problem, alpha)), rounding)
                << method_name(method) << ", alpha " << alpha;
            EXPECT_TRUE(solution.report.converged) << method_name(method) << ", alpha " << alpha;
        }
}

TEST(L2Precision, RelaxedArithmeticReachesTheSameLevel) {
    const PoissonProblem problem = make_poisson_problem(129, 65, 3, 12);
    PoissonSolver solver(test_device(), problem.width, problem.height, problem.channels, Precision::relaxed);
    for (const LinearMethod method : linear_methods) {
        const Solution solution = solve(solver, problem.images(), l2_options(method));
        EXPECT_LE(relative_error(solution.image, solve_directly(problem, 0.2)), 1e-3) << method_name(method);
        EXPECT_TRUE(solution.report.converged) << method_name(method);
    }
}

} // namespace
} // namespace gradus::testing
