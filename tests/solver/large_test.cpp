// Images of 8 and 16 Mpixel: sums of so many floats must not end the iteration early.
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

/// `count` by `count` copies, each the mirror image of its neighbours, so that the solution is the copies of the
/// tile's: across a seam there is no difference, and the border of the tile is none either.
PoissonProblem mirrored(const PoissonProblem &tile, std::uint32_t count) {
    PoissonProblem problem;
    problem.width = count * tile.width;
    problem.height = count * tile.height;
    problem.channels = tile.channels;
    const std::size_t size = problem.pixels() * problem.channels;
    for (std::vector<float> *image : {&problem.clean, &problem.primal, &problem.dx, &problem.dy,
                                      &problem.primal_variance, &problem.dx_variance, &problem.dy_variance})
        image->resize(size);
    // Those of seams leave the mean, by which weights go, as it is.
    const float of_seam_x = float(means(tile.dx_variance, 1)[0] * tile.width / (tile.width - 1.0)),
                of_seam_y = float(means(tile.dy_variance, 1)[0] * tile.height / (tile.height - 1.0));
    const auto place = [](std::uint32_t i, std::uint32_t side, bool &is_turned) {
        is_turned = i / side % 2 == 1;
        return is_turned ? side - 1 - i % side : i % side;
    };
    for (std::uint32_t c = 0; c < problem.channels; ++c)
        for (std::uint32_t y = 0; y < problem.height; ++y)
            for (std::uint32_t x = 0; x < problem.width; ++x) {
                bool turned_x = false, turned_y = false;
                const std::uint32_t tx = place(x, tile.width, turned_x), ty = place(y, tile.height, turned_y);
                const std::size_t to = problem.at(c, x, y), from = tile.at(c, tx, ty);
                problem.clean[to] = tile.clean[from];
                problem.primal[to] = tile.primal[from];
                problem.primal_variance[to] = tile.primal_variance[from];
                const bool seam_x = x % tile.width + 1 == tile.width, seam_y = y % tile.height + 1 == tile.height;
                const std::size_t edge_x = tile.at(c, turned_x ? tx - (seam_x ? 0 : 1) : tx, ty),
                                  edge_y = tile.at(c, tx, turned_y ? ty - (seam_y ? 0 : 1) : ty);
                problem.dx[to] = seam_x ? 0 : (turned_x ? -1.0f : 1.0f) * tile.dx[edge_x];
                problem.dy[to] = seam_y ? 0 : (turned_y ? -1.0f : 1.0f) * tile.dy[edge_y];
                problem.dx_variance[to] = seam_x ? of_seam_x : tile.dx_variance[edge_x];
                problem.dy_variance[to] = seam_y ? of_seam_y : tile.dy_variance[edge_y];
            }
    return problem;
}

TEST(FullLarge, WeightedSolutionOfSixteenMegapixelsIsThatOfItsTiles) {
    constexpr std::uint32_t side = 512, count = 8;
    const PoissonProblem tile = make_jumping_problem(side, side, 3, 3), large = mirrored(tile, count);
    PoissonOptions options = l2_options(LinearMethod::automatic, 0.2, 1e-6);
    options.weigh_by_variance = options.alpha_from_variances = true;
    options.largest_weight = 1000;
    const auto solved = [&](const PoissonProblem &problem) {
        PoissonSolver solver(test_device(), problem.width, problem.height, 3);
        return solve(solver, problem.images_with_variances(), options);
    };
    const Solution of_tile = solved(tile), of_large = solved(large);
    PoissonProblem copies = tile;
    copies.primal = of_tile.image;
    const double error = relative_error(of_large.image, to_double(mirrored(copies, count).primal)),
                 noise = relative_error(of_tile.image, to_double(tile.clean));
    std::printf("relative distance %.2e, %d steps; of the tile %d, whose noise is %.2e\n", error,
                of_large.report.iterations, of_tile.report.iterations, noise);
    EXPECT_TRUE(of_tile.report.converged);
    EXPECT_TRUE(of_large.report.converged);
    // Both stop at the same residual, far below what the noise leaves.
    EXPECT_LE(error, 0.01 * noise);
}

} // namespace
} // namespace gradus::testing
