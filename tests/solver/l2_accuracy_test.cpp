// The L2 solution against the direct one in double precision: every method, at several tolerances, for images of every
// awkward size.
#include "tests/solver/solver_fixture.h"
#include "tests/support/stability.h"
#include "tests/support/worse.h"

namespace gradus::testing {
namespace {

class L2Accuracy : public ::testing::TestWithParam<LinearMethod> {
  protected:
    LinearMethod method() const { return GetParam(); }

    /// Jacobi's method takes 1e5 steps at alpha = 0.02.
    std::vector<double> alphas() const {
        return method() == LinearMethod::jacobi ? std::vector{0.2, 2.0} : std::vector{0.02, 0.2, 2.0};
    }

    void check(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
               const std::vector<double> &some_alphas) {
        const PoissonProblem problem = make_poisson_problem(width, height, channels, width + 31 * height);
        PoissonSolver &solver = solver_for(problem);
        for (const double alpha : some_alphas) {
            const std::vector<double> reference = solve_directly(problem, alpha);
            const double floor = float_floor(problem, alpha, reference);
            // |error| <= |residual| / alpha^2, and tolerances are relative to the residual at the primal.
            const double at_start = residual_norm(problem, alpha, unit_weights(problem), to_double(problem.primal));
            const double safe = at_start > 0 ? std::min(1.0, alpha * alpha * norm(reference) / at_start) : 1.0;
            for (const double level : {1e-3, 1e-5, 0.0}) {
                PoissonOptions options = l2_options(method(), alpha, std::max(level * safe, 1e-9));
                options.iterations = enough_steps(method(), alpha, 1e9 / safe);
                const Solution solution = solve(solver, problem.images(), options);
                const double error = relative_error(solution.image, reference);
                EXPECT_LE(error, std::max(level, floor))
                    << width << " x " << height << ", alpha " << alpha << ", level " << level << ", "
                    << solution.report.iterations << " steps";
                worst_ = worse(worst_, error / std::max(level, floor));
            }
        }
    }

    void TearDown() override { std::printf("largest error: %.2f of what is allowed\n", worst_); }

    double worst_ = 0; ///< largest error over what is allowed
};

TEST_P(L2Accuracy, OfTinyImages) {
    constexpr std::uint32_t sizes[][2] = {{1, 1}, {2, 1}, {1, 2}, {2, 2}, {3, 2}, {5, 4}, {17, 9}, {16, 16}, {33, 3}};
    for (const auto &[width, height] : sizes)
        check(width, height, 1, alphas());
}

TEST_P(L2Accuracy, OfLines) {
    check(1, 301, 3, alphas());
    check(301, 1, 1, alphas());
    check(1024, 1, 1, alphas());
    check(2, 257, 1, alphas());
    record_stability({"Reconstruction", "1 x N images: grids that cannot be halved, pixels without neighbours",
                      "301, 1024 and 514 pixels in lines, alpha 0.02 to 2, L2, every method", "solved as any other",
                      "largest error against double, over tolerance and rounding", worst_, 1});
}

TEST_P(L2Accuracy, OfOddSizes) {
    check(129, 65, 3, alphas());
    check(333, 501, 3, {0.2});
}

TEST_P(L2Accuracy, OfSmallRenders) {
    check(640, 360, 3, {0.2});
    check(97, 60, 8, {0.2});
    check(640, 360, 1, {method() == LinearMethod::jacobi ? 2.0 : alphas()[0]});
}

/// Conjugate gradients on a problem: the error, where the tolerance promises `level`.
double error_of_conjugate_gradients(const PoissonProblem &problem, double level) {
    constexpr double alpha = 0.2;
    const std::vector<double> reference = solve_directly(problem, alpha);
    // As in check() above.
    const double at_start = residual_norm(problem, alpha, unit_weights(problem), to_double(problem.primal));
    const double tolerance = level * alpha * alpha * norm(reference) / at_start;
    const Solution solution = solve(problem, l2_options(LinearMethod::cg, alpha, tolerance));
    EXPECT_TRUE(solution.report.converged);
    return relative_error(solution.image, reference);
}

/// Products are summed tile by tile; here there are several in each direction.
TEST(L2AccuracyLarge, OfWideImages) {
    EXPECT_LE(error_of_conjugate_gradients(make_poisson_problem(1701, 20, 3, 1), 1e-4), 1e-4);
}

/// large_test.cpp has images of 8 Mpixel.
TEST(FullL2AccuracyLarge, OfFourMillionPixels) {
    constexpr double level = 1e-4;
    const double error = error_of_conjugate_gradients(make_poisson_problem(2048, 2048, 1, 1), level);
    record_stability({"Reconstruction", "very large images: sums of millions of floats stall conjugate gradients",
                      "2048 x 2048 pixels, L2, conjugate gradients", "sums in parts, compensated, in a fixed order",
                      "relative error against double, where the tolerance promises 1e-4", error, level});
}

INSTANTIATE_TEST_SUITE_P(Solver, L2Accuracy,
                         ::testing::Values(LinearMethod::automatic, LinearMethod::pcg, LinearMethod::multigrid),
                         method_parameter_name);
INSTANTIATE_TEST_SUITE_P(Full, L2Accuracy, ::testing::Values(LinearMethod::cg, LinearMethod::jacobi),
                         method_parameter_name);

} // namespace
} // namespace gradus::testing
