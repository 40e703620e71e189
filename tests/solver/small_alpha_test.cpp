// Data terms so light that rounding errors say more about the mean of the solution than they do.
#include "tests/solver/solver_fixture.h"
#include "tests/support/stability.h"
#include "tests/support/worse.h"

#include <random>

namespace gradus::testing {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// With values missing here and there, and all differences across the middle: two pieces at least.
PoissonProblem cut_problem(std::uint32_t width, std::uint32_t height, std::uint64_t seed) {
    PoissonProblem problem = make_poisson_problem(width, height, 3, seed);
    std::mt19937_64 random(seed);
    for (std::vector<float> *plane : {&problem.primal, &problem.dx, &problem.dy})
        for (float &value : *plane)
            if (random() % 64 == 0)
                value = nan;
    for (std::uint32_t y = 0; y < height; ++y)
        problem.dx[problem.at(1, width / 2, y)] = nan;
    return problem;
}

/// By pixel, the number of its piece: pixels that differences join.
std::vector<std::size_t> pieces_of(const PoissonProblem &problem, const PoissonWeights &weights) {
    const std::size_t none = problem.pixels();
    std::vector<std::size_t> piece(problem.pixels(), none), open;
    for (std::size_t first = 0; first < problem.pixels(); ++first) {
        if (piece[first] != none)
            continue;
        piece[first] = first;
        for (open = {first}; !open.empty();) {
            const std::size_t at = open.back(), up = at - problem.width;
            open.pop_back();
            const auto reach = [&](std::size_t other, double weight) {
                if (weight > 0 && piece[other] == none) {
                    piece[other] = first;
                    open.push_back(other);
                }
            };
            reach(at + 1, weights.dx[at]);
            reach(at + problem.width, weights.dy[at]);
            if (at % problem.width > 0)
                reach(at - 1, weights.dx[at - 1]);
            if (at >= problem.width)
                reach(up, weights.dy[up]);
        }
    }
    return piece;
}

/// The largest mean of image - primal over what a piece has of the primal, relative to the primal's mean.
double worst_mean(const PoissonProblem &problem, const std::vector<float> &image) {
    const PoissonWeights weights = unit_weights(problem);
    const std::vector<std::size_t> piece = pieces_of(problem, weights);
    double worst = 0;
    for (std::uint32_t c = 0; c < problem.channels; ++c) {
        std::vector<double> sums(problem.pixels()), counts(problem.pixels());
        double mean = 0, count = 0;
        for (std::size_t i = 0; i < problem.pixels(); ++i) {
            const std::size_t at = c * problem.pixels() + i;
            if (weights.primal[at] == 0)
                continue;
            sums[piece[i]] += double(image[at]) - double(problem.primal[at]);
            ++counts[piece[i]];
            mean += problem.primal[at];
            ++count;
        }
        for (std::size_t i = 0; i < problem.pixels(); ++i)
            if (counts[i] > 1) // a pixel alone may be filled from its neighbours
                worst = worse(worst, std::abs(sums[i] / counts[i]) / (mean / count));
    }
    return worst;
}

TEST(SmallAlpha, LeavesTheMeanOfEachPiece) {
    double mean = 0, residual = 0;
    for (const auto &[width, height] : {std::pair{129u, 3u}, {1u, 257u}, {64u, 48u}, {200u, 150u}})
        for (const std::uint64_t seed : {1u, 2u}) {
            const PoissonProblem problem = cut_problem(width, height, seed);
            const PoissonWeights weights = unit_weights(problem);
            for (const double alpha : {0.0, 1e-7, 1e-5, 1e-4, 1e-3, 9e-3})
                for (const double tolerance : {0.0, 1e-7, 1e-9}) {
                    const PoissonOptions options = l2_options(LinearMethod::automatic, alpha, tolerance);
                    const Solution solution = solve(solver_for(problem), problem.images(), options);
                    mean = worse(mean, worst_mean(problem, solution.image));
                    residual = worse(residual, relative_residual(problem, alpha, weights, to_double(solution.image)));
                }
        }
    constexpr double allowed_mean = 2e-6, allowed_residual = 1e-4;
    EXPECT_LE(mean, allowed_mean);
    EXPECT_LE(residual, allowed_residual) << "digits are lost to means that rounding errors made";
    record_stability({"Reconstruction", "data terms so light that rounding errors tell the mean",
                      "alpha 0 to 0.009, L2, values missing, tolerances down to 1e-9; four sizes",
                      "the mean of each piece is set; steps end where residuals grow",
                      "largest mean of a piece off the primal's, relative to the primal's mean", mean, allowed_mean});
}

/// Against reweightings in double. In lines differences alone can be met exactly, so without a data term no objective
/// is left.
TEST(SmallAlpha, HasTheObjectiveOfL1) {
    constexpr double allowed = 1.05; // of 20 reweightings; lines take 40 and more (L1Objective.OfLines)
    double largest = 0;
    for (const auto &[width, height] : {std::pair{7u, 1u}, {1u, 31u}, {300u, 1u}, {3u, 3u}, {8u, 8u}, {64u, 48u}})
        for (const std::uint64_t seed : {1u, 2u}) {
            const PoissonProblem problem = make_poisson_problem(width, height, 3, seed);
            for (const double alpha : {0.0, 1e-4, 1e-3, 5e-3, 2e-2}) {
                if (alpha == 0 && std::min(width, height) == 1)
                    continue;
                const Solution solution = solve(problem, plain_l1_options(alpha));
                const double objective = l1_objective(problem, alpha, to_double(solution.image), true);
                const double reference = l1_objective(problem, alpha, solve_l1(problem, alpha, true, 40, 100), true);
                EXPECT_LE(objective, allowed * reference) << width << " x " << height << ", alpha " << alpha;
                largest = worse(largest, objective / reference - 1);
            }
        }
    record_stability({"Reconstruction", "data terms so light that rounding errors tell the mean",
                      "alpha 0 to 0.02, L1, lines and small images", "the mean of each piece is set after each step",
                      "how far the objective is above that of 40 reweightings in double, relatively", largest,
                      allowed - 1});
}

/// With alpha 0 a pixel's own datum is an equation that no diagonal has. One beside it that has not even that is
/// filled.
TEST(SmallAlpha, LeavesThePixelsThatNothingJoinsToOthers) {
    constexpr std::uint32_t width = 33, height = 9;
    constexpr std::uint32_t alone[][2] = {{0, 0}, {12, 5}, {width - 1, 3}, {20, 4}}, empty = 3;
    PoissonProblem problem = make_poisson_problem(width, height, 3, 3);
    for (const auto &[x, y] : alone) {
        const std::size_t at = problem.at(1, x, y); // what lacks one channel lacks all
        problem.dx[at] = problem.dy[at] = nan;
        if (x > 0)
            problem.dx[at - 1] = nan;
        if (y > 0)
            problem.dy[at - width] = nan;
        for (std::uint32_t c = 0; c < 3; ++c)
            problem.primal[problem.at(c, x, y)] = 50 + float(x);
    }
    problem.primal[problem.at(1, alone[empty][0], alone[empty][1])] = nan;
    for (const PoissonNorm norm : {PoissonNorm::l2, PoissonNorm::l1}) {
        PoissonOptions options;
        options.norm = norm;
        options.alpha = 0;
        options.keep_mean = false;
        const Solution solution = solve(problem, options);
        EXPECT_EQ(solution.report.filled, 1u);
        for (std::uint32_t c = 0; c < 3; ++c)
            for (std::uint32_t i = 0; i < 4; ++i) {
                const std::size_t at = problem.at(c, alone[i][0], alone[i][1]);
                if (i != empty)
                    EXPECT_FLOAT_EQ(solution.image[at], problem.primal[at]);
                else
                    EXPECT_LT(solution.image[at], 50) << "the mean of its neighbours";
            }
    }
}

} // namespace
} // namespace gradus::testing
