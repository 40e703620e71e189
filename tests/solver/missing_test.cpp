// NaN and infinity in the inputs: counted, given weight 0, and never spread. The reference leaves out those equations.
#include "tests/solver/solver_fixture.h"
#include "tests/support/stability.h"
#include "tests/support/worse.h"

#include <random>

namespace gradus::testing {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
constexpr std::uint32_t width = 75, height = 43;

/// The solution of the equations that are there, and how the solver's differs from it at pixels that have any.
std::vector<double> solve_known(const PoissonProblem &problem, double alpha) {
    return solve_weighted(problem, alpha, unit_weights(problem), std::vector<double>(problem.primal.size()), 20000,
                          1e-13);
}

double largest_difference(const std::vector<float> &image, const std::vector<double> &reference) {
    double largest = 0;
    for (std::size_t i = 0; i < image.size(); ++i)
        largest = worse(largest, std::abs(image[i] - reference[i]));
    return largest;
}

class MissingInputs : public ::testing::TestWithParam<LinearMethod> {
  protected:
    /// Jacobi's method damped: a pixel cut off from all others has a checkerboard of its own.
    static PoissonOptions options() {
        PoissonOptions options = l2_options(GetParam(), 0.2, 1e-6);
        options.damping = GetParam() == LinearMethod::jacobi ? 0.8 : 1.0;
        return options;
    }
    static void record(const char *provoked_by, double largest) {
        record_stability({"Reconstruction", "NaN and infinity spread over the image", provoked_by,
                          "leaves out those equations, counts them in the report",
                          "largest error of a pixel, against the solution without them in double", largest, allowed});
    }
    static constexpr double allowed = 1e-3; ///< largest value about 8, |residual| / alpha^2 relative 2.5e-5 on average
};

TEST_P(MissingInputs, OneOfThem) {
    PoissonProblem problem = make_poisson_problem(width, height, 3, 1);
    PoissonSolver &solver = solver_for(problem);
    int number = 0;
    double largest = 0;
    for (std::vector<float> *plane : {&problem.primal, &problem.dx, &problem.dy})
        for (const float value : {nan, infinity, -infinity}) {
            const std::size_t place = problem.at(std::uint32_t(number++ % 3), 20, 11);
            const float kept = std::exchange((*plane)[place], value);
            const Solution solution = solve(solver, problem.images(), options());
            EXPECT_EQ(solution.report.missing_primal, plane == &problem.primal ? 1u : 0u);
            EXPECT_EQ(solution.report.missing_dx, plane == &problem.dx ? 1u : 0u);
            EXPECT_EQ(solution.report.missing_dy, plane == &problem.dy ? 1u : 0u);
            EXPECT_EQ(solution.report.filled, 0u);
            const double difference = largest_difference(solution.image, solve_known(problem, 0.2));
            EXPECT_LE(difference, allowed) << value << " in input "
                                           << (plane == &problem.primal ? "primal"
                                               : plane == &problem.dx   ? "dx"
                                                                        : "dy");
            largest = worse(largest, difference);
            (*plane)[place] = kept;
        }
    record("NaN and both infinities, one pixel of each input", largest);
}

TEST_P(MissingInputs, AtCornersAndEdges) {
    PoissonProblem problem = make_poisson_problem(width, height, 3, 2);
    problem.primal[problem.at(0, 0, 0)] = nan;
    problem.primal[problem.at(1, width - 1, height - 1)] = infinity;
    problem.dx[problem.at(2, 0, 0)] = nan;
    problem.dx[problem.at(2, width - 2, height - 1)] = nan;
    problem.dy[problem.at(2, width - 2, height - 2)] = nan; // the corner keeps its other neighbour
    problem.dy[problem.at(2, 0, 15)] = -infinity;
    const Solution solution = solve(problem, options());
    EXPECT_EQ(solution.report.missing_primal, 2u);
    EXPECT_EQ(solution.report.missing_dx, 2u);
    EXPECT_EQ(solution.report.missing_dy, 2u);
    EXPECT_EQ(solution.report.filled, 0u);
    EXPECT_LE(largest_difference(solution.image, solve_known(problem, 0.2)), allowed);
}

/// Some pixels in a hundred of each input; each pixel keeps an equation, which the reference needs.
TEST_P(MissingInputs, ManyOfThem) {
    PoissonProblem problem = make_poisson_problem(129, 65, 3, 3);
    std::mt19937_64 random(4);
    std::uint64_t counts[3] = {};
    std::vector<float> *const planes[] = {&problem.primal, &problem.dx, &problem.dy};
    for (std::size_t i = 0; i < problem.pixels(); ++i) {
        const std::size_t which = random() % 60; // 0 to 2: missing there
        if (which > 2 || i % 129 == 128 || i / 129 == 64)
            continue;
        (*planes[which])[random() % 3 * problem.pixels() + i] = random() % 2 ? nan : infinity;
        ++counts[which];
    }
    const Solution solution = solve(problem, options());
    EXPECT_EQ(solution.report.missing_primal, counts[0]);
    EXPECT_EQ(solution.report.missing_dx, counts[1]);
    EXPECT_EQ(solution.report.missing_dy, counts[2]);
    record("NaN and infinity in one of twenty pixels", largest_difference(solution.image, solve_known(problem, 0.2)));
}

INSTANTIATE_TEST_SUITE_P(Solver, MissingInputs, ::testing::ValuesIn(linear_methods), method_parameter_name);

/// Takes all equations away from the pixels of a rectangle.
void blot(PoissonProblem &problem, std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1) {
    for (std::uint32_t y = y0; y < y1; ++y)
        for (std::uint32_t x = x0; x < x1; ++x) {
            problem.primal[problem.at(1, x, y)] = nan;
            problem.dx[problem.at(1, x, y)] = problem.dy[problem.at(1, x, y)] = nan;
            if (x > 0)
                problem.dx[problem.at(1, x - 1, y)] = nan;
            if (y > 0)
                problem.dy[problem.at(1, x, y - 1)] = nan;
        }
}

class MissingPixels : public ::testing::TestWithParam<PoissonNorm> {
  protected:
    static PoissonOptions options() {
        PoissonOptions options;
        options.norm = GetParam();
        options.keep_mean = false;
        return options;
    }
};

TEST_P(MissingPixels, TakeTheMeanOfTheirNeighbours) {
    for (const auto &[x, y] : {std::pair{20u, 11u}, {0u, 0u}, {width - 1, height - 1}, {0u, 12u}, {9u, height - 1}}) {
        PoissonProblem problem = make_poisson_problem(width, height, 3, 5);
        blot(problem, x, y, x + 1, y + 1);
        const Solution solution = solve(problem, options());
        EXPECT_EQ(solution.report.filled, 1u);
        for (std::uint32_t c = 0; c < 3; ++c) {
            double sum = 0, count = 0;
            for (const auto &[dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
                const int nx = int(x) + dx, ny = int(y) + dy;
                if (nx >= 0 && ny >= 0 && nx < int(width) && ny < int(height)) {
                    sum += solution.image[problem.at(c, std::uint32_t(nx), std::uint32_t(ny))];
                    count += 1;
                }
            }
            EXPECT_NEAR(solution.image[problem.at(c, x, y)], sum / count, 1e-5 * (1 + std::abs(sum)))
                << x << ", " << y << ", channel " << c;
        }
    }
}

TEST_P(MissingPixels, InABlockLieBetweenTheirSurroundings) {
    PoissonProblem problem = make_poisson_problem(width, height, 3, 6);
    constexpr std::uint32_t x0 = 20, y0 = 10, x1 = 37, y1 = 24;
    blot(problem, x0, y0, x1, y1);
    const Solution solution = solve(problem, options());
    EXPECT_EQ(solution.report.filled, (x1 - x0) * (y1 - y0));
    EXPECT_EQ(count_non_finite(solution.image), 0u);
    double outside = 0;
    for (std::uint32_t c = 0; c < 3; ++c) {
        float least = infinity, most = -infinity;
        for (std::uint32_t y = y0 - 1; y <= y1; ++y)
            for (std::uint32_t x = x0 - 1; x <= x1; ++x)
                if (x < x0 || y < y0 || x >= x1 || y >= y1) {
                    least = std::min(least, solution.image[problem.at(c, x, y)]);
                    most = std::max(most, solution.image[problem.at(c, x, y)]);
                }
        for (std::uint32_t y = y0; y < y1; ++y)
            for (std::uint32_t x = x0; x < x1; ++x) {
                const double value = solution.image[problem.at(c, x, y)];
                outside = std::max({outside, least - value, value - most});
            }
    }
    record_stability({"Reconstruction", "regions without any equation: nothing says what is there",
                      "a block of 17 x 14 pixels, NaN in all inputs", "filled from its surroundings and counted",
                      "how far a filled pixel is outside of what surrounds it", outside, 1e-5});
}

TEST_P(MissingPixels, AllTakeTheOnlyValue) {
    constexpr std::uint32_t wide = 601, high = 423, x = 130, y = 400;
    PoissonProblem problem = make_poisson_problem(wide, high, 3, 9);
    blot(problem, 0, 0, wide, high);
    for (std::uint32_t c = 0; c < 3; ++c)
        problem.primal[problem.at(c, x, y)] = 0.7f + float(c);
    const Solution solution = solve(problem, options());
    EXPECT_EQ(solution.report.filled, wide * high - 1);
    for (std::uint32_t c = 0; c < 3; ++c)
        for (std::uint32_t i = 0; i < wide * high; ++i)
            ASSERT_FLOAT_EQ(solution.image[c * wide * high + i], 0.7f + float(c)) << i;
}

TEST_P(MissingPixels, OfRingsHaveTheMeanOfTheRingBefore) {
    // One row: 0 at one end and 6 at the other; between them three pixels from each side, and one that has both.
    constexpr std::uint32_t wide = 9;
    PoissonProblem problem = make_poisson_problem(wide, 1, 3, 10);
    blot(problem, 0, 0, wide, 1);
    for (std::uint32_t c = 0; c < 3; ++c) {
        problem.primal[problem.at(c, 0, 0)] = 0;
        problem.primal[problem.at(c, wide - 1, 0)] = 6;
    }
    const Solution solution = solve(problem, options());
    for (std::uint32_t x = 0; x < wide; ++x)
        EXPECT_FLOAT_EQ(solution.image[problem.at(1, x, 0)], x < 4 ? 0.0f : x > 4 ? 6.0f : 3.0f) << x;
}

/// Where gradients tie pixels to each other but nothing ties them to the rest, their level is nobody's to say; it must
/// be finite all the same, and the rest must not notice.
TEST_P(MissingPixels, ThatFormAnIslandAreFinite) {
    PoissonProblem problem = make_poisson_problem(width, height, 3, 7);
    PoissonProblem without = problem;
    blot(without, 20, 10, 30, 20);
    blot(problem, 20, 10, 30, 20);
    for (std::uint32_t c = 0; c < 3; ++c)
        for (std::uint32_t y = 10; y < 20; ++y)
            for (std::uint32_t x = 20; x < 30; ++x) {
                const std::size_t i = problem.at(c, x, y);
                if (x + 1 < 30)
                    problem.dx[i] = 0.01f;
                if (y + 1 < 20)
                    problem.dy[i] = -0.02f;
            }
    const Solution island = solve(problem, options()), blank = solve(without, options());
    EXPECT_EQ(count_non_finite(island.image), 0u);
    double largest = 0, away = 0;
    for (std::uint32_t c = 0; c < 3; ++c)
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                const std::size_t i = problem.at(c, x, y);
                if (x >= 20 && x < 30 && y >= 10 && y < 20)
                    largest = worse(largest, double(std::abs(island.image[i])));
                else
                    away = worse(away, double(std::abs(island.image[i] - blank.image[i])));
            }
    EXPECT_LE(largest, 100);
    record_stability(
        {"Reconstruction", "regions that nothing ties to the rest: their level is free",
         GetParam() == PoissonNorm::l2 ? "an island of 10 x 10 pixels, L2" : "an island of 10 x 10 pixels, L1",
         "finite, and the rest does not notice", "largest change of a pixel elsewhere", away,
         GetParam() == PoissonNorm::l2 ? 1e-3 : 0.05});
}

TEST_P(MissingPixels, CanBeAll) {
    for (const auto &[w, h] : {std::pair{width, height}, {1u, 1u}, {1u, 301u}}) {
        PoissonProblem problem = make_poisson_problem(w, h, 3, 8);
        for (std::vector<float> *plane : {&problem.primal, &problem.dx, &problem.dy})
            plane->assign(plane->size(), nan);
        PoissonSolver &solver = solver_for(problem);
        for (const bool keep_mean : {false, true}) {
            PoissonOptions some = options();
            some.keep_mean = keep_mean;
            const Solution solution = solve(solver, problem.images(), some);
            EXPECT_EQ(count_non_finite(solution.image), 0u);
            EXPECT_EQ(solution.report.missing_primal, problem.pixels());
            EXPECT_EQ(solution.report.filled, problem.pixels());
        }
    }
}

TEST_P(MissingPixels, WithoutAnyPrimalDifferencesDecideAllButTheLevel) {
    PoissonProblem problem = make_exact_problem(width, height, 3);
    problem.primal.assign(problem.primal.size(), nan);
    const Solution solution = solve(problem, options());
    EXPECT_EQ(count_non_finite(solution.image), 0u);
    if (GetParam() == PoissonNorm::l1)
        return; // reweighting is slow where nothing holds the levels of flat parts
    const std::vector<double> level = means(solution.image, 3), clean = means(problem.clean, 3);
    for (std::uint32_t c = 0; c < 3; ++c)
        for (std::size_t i = c * problem.pixels(); i < (c + 1) * problem.pixels(); ++i)
            ASSERT_NEAR(solution.image[i] - level[c], problem.clean[i] - clean[c], 1e-2) << i;
}

TEST_P(MissingPixels, WithoutAnyDifferencesThePrimalIsReturned) {
    PoissonProblem problem = make_poisson_problem(width, height, 3, 9);
    problem.dx.assign(problem.dx.size(), nan);
    problem.dy.assign(problem.dy.size(), infinity);
    const Solution solution = solve(problem, options());
    EXPECT_EQ(solution.report.missing_dx, (width - 1) * height);
    EXPECT_EQ(solution.report.missing_dy, width * (height - 1));
    EXPECT_LE(relative_error(solution.image, to_double(problem.primal)), 1e-6);
}

TEST_P(MissingPixels, InOtherImagesDoNotSpread) {
    const PoissonProblem problem = make_poisson_problem(width, height, 3, 10);
    PoissonSolver &solver = solver_for(problem);
    const Solution expected = solve(solver, problem.images(), options());
    std::vector<float> start = problem.clean, direct(problem.primal.size());
    start[100] = nan;
    start[500] = infinity;
    HostImages images = problem.images();
    images.start = start.data();
    const Solution started = solve(solver, images, options());
    EXPECT_EQ(count_non_finite(started.image), 0u);
    if (GetParam() == PoissonNorm::l2) {
        EXPECT_LE(relative_error(started.image, to_double(expected.image)), 1e-3);
    }
    direct[100] = nan;
    images.start = nullptr;
    images.direct = direct.data();
    EXPECT_LE(count_non_finite(solve(solver, images, options()).image), 1u) << "direct light stays where it is";
}

INSTANTIATE_TEST_SUITE_P(Solver, MissingPixels, ::testing::Values(PoissonNorm::l1, PoissonNorm::l2),
                         [](const auto &info) { return info.param == PoissonNorm::l1 ? "L1" : "L2"; });

/// The reference knows the L1 problem with the missing equations left out.
TEST(MissingInputsL1, ObjectiveIsThatOfTheKnownEquations) {
    PoissonProblem problem = make_poisson_problem(width, height, 3, 11);
    std::mt19937_64 random(12);
    for (std::vector<float> *plane : {&problem.primal, &problem.dx, &problem.dy})
        for (int k = 0; k < 60; ++k)
            (*plane)[random() % plane->size()] = k % 2 ? nan : -infinity;
    const Solution solution = solve(problem, plain_l1_options());
    EXPECT_EQ(count_non_finite(solution.image), 0u);
    record_stability({"Reconstruction", "NaN and infinity spread over the image", "60 of them in each input, L1",
                      "leaves out those equations, counts them in the report",
                      "how far the objective is above that of 60 reweightings in double, relatively",
                      std::max(l1_objective(problem, 0.2, to_double(solution.image), true) /
                                       l1_objective(problem, 0.2, solve_l1(problem, 0.2, true), true) -
                                   1,
                               0.0),
                      0.001});
}

/// Pixels that have differences alone are not lost beside those that have data, however much these weigh.
TEST(MissingPrimal, OfALargeAlphaIsThatOfTheDifferences) {
    PoissonProblem half = make_poisson_problem(64, 64, 3, 13);
    std::fill_n(half.primal.begin() + 32 * 64, 32 * 64, nan); // what lacks one channel lacks all
    PoissonProblem few = make_poisson_problem(47, 33, 3, 14);
    for (const auto &[x, y] : {std::pair{3u, 5u}, {20u, 0u}, {46u, 32u}})
        few.primal[few.at(1, x, y)] = nan;
    for (const PoissonProblem &problem : {half, few}) {
        const std::vector<double> reference = solve_known(problem, 100);
        for (const double alpha : {100.0, 1e3, 3e3, 1e5, 1e8, 1e12}) {
            const PoissonOptions options = l2_options(LinearMethod::automatic, alpha, 1e-6);
            const Solution solution = solve(problem, options);
            EXPECT_EQ(solution.report.alpha, 100);
            EXPECT_TRUE(solution.report.converged) << alpha;
            // The residual is at most 1e-6 of ||b||, about 100, and the slowest mode of the missing half has the
            // eigenvalue (pi / 64)^2.
            EXPECT_LE(largest_difference(solution.image, reference), 0.04) << alpha;
        }
        // From variances, with weights by them: all are 1.
        std::vector<float> small(problem.primal.size(), 1e-10f), large(problem.primal.size(), 1e5f);
        HostImages images = problem.images();
        images.primal_variance = small.data();
        images.dx_variance = images.dy_variance = large.data();
        PoissonOptions options = l2_options(LinearMethod::automatic, 0.2, 1e-6);
        options.alpha_from_variances = options.weigh_by_variance = true;
        const Solution solution = solve(solver_for(problem), images, options);
        EXPECT_EQ(solution.report.alpha, 100);
        EXPECT_LE(largest_difference(solution.image, reference), 0.04);
    }
}

} // namespace
} // namespace gradus::testing
