// Constant images: residuals and right sides of 0, where iterations divide by their norms.
#include "tests/solver/solver_fixture.h"
#include "tests/support/stability.h"
#include "tests/support/worse.h"

namespace gradus::testing {
namespace {

class ConstantImages : public ::testing::TestWithParam<PoissonNorm> {};

TEST_P(ConstantImages, ComeBackAsTheyAre) {
    double worst = 0;
    for (const float value : {0.0f, 1e-20f, 1.0f, 3e7f}) {
        PoissonProblem problem = make_exact_problem(75, 43, 3);
        problem.primal.assign(problem.primal.size(), value);
        problem.dx.assign(problem.dx.size(), 0);
        problem.dy.assign(problem.dy.size(), 0);
        PoissonOptions options;
        options.norm = GetParam();
        const Solution solution = solve(problem, options);
        EXPECT_TRUE(solution.report.converged) << value;
        for (const float found : solution.image)
            worst = worse(worst, std::abs(double(found) - value) / (value > 0 ? value : 1));
    }
    record_stability(
        {"Reconstruction", "constant images: norms of 0 in denominators",
         GetParam() == PoissonNorm::l1 ? "all pixels 0, 1e-20, 1 or 3e7, L1" : "all pixels 0, 1e-20, 1 or 3e7, L2",
         "returned as they are", "largest relative error of a pixel", worst, 2 * rounding});
}

INSTANTIATE_TEST_SUITE_P(Solver, ConstantImages, ::testing::Values(PoissonNorm::l1, PoissonNorm::l2),
                         [](const auto &info) { return info.param == PoissonNorm::l1 ? "L1" : "L2"; });

} // namespace
} // namespace gradus::testing
