// The L1 objective against 60 reweightings in double precision, each solved by at most 200 steps of conjugate
// gradients.
#include "tests/solver/solver_fixture.h"
#include "tests/support/stability.h"
#include "tests/support/worse.h"

namespace gradus::testing {
namespace {

constexpr double allowed = 1.001;

/// Solves with the default tolerance and compares the objectives of the image, computed in double: their ratio.
double compare(const std::string &name, const PoissonProblem &problem, double alpha, bool joint, int reweightings = 0) {
    PoissonOptions options = plain_l1_options(alpha);
    options.iterations = reweightings;
    if (reweightings > 0)
        options.tolerance = 1e-7;
    options.joint_channels = joint;
    const Solution solution = solve(problem, options);
    const double objective = l1_objective(problem, alpha, to_double(solution.image), joint);
    const double reference = l1_objective(problem, alpha, solve_l1(problem, alpha, joint), joint);
    std::printf("%-28s objective %.6g, reference %.6g (%+.3f %%), %d reweightings, %d steps\n", name.c_str(), objective,
                reference, 100 * (objective / reference - 1), solution.report.reweightings, solution.report.iterations);
    EXPECT_LE(objective, reference * allowed) << name;
    EXPECT_NEAR(solution.report.objective / objective, 1, 1e-5) << name;
    return objective / reference;
}

constexpr const char *objective_excess = "how far the objective is above that of 60 reweightings in double, relatively";

/// What is recorded of a ratio of objectives.
double excess(double ratio) { return std::max(ratio - 1, 0.0); }

TEST(L1Objective, OfNoiseWithOutliers) {
    compare("96 x 64", make_poisson_problem(96, 64, 3, 1), 0.2, true);
    compare("96 x 64, by channel", make_poisson_problem(96, 64, 3, 1), 0.2, false);
    compare("75 x 53, one channel", make_poisson_problem(75, 53, 1, 2), 0.2, true);
}

TEST(FullL1Objective, OfALargerImage) { compare("192 x 128", make_poisson_problem(192, 128, 3, 3), 0.2, true); }

TEST(L1Objective, OfOtherAlphas) {
    compare("61 x 43, alpha 0.05", make_poisson_problem(61, 43, 3, 4), 0.05, true);
    compare("61 x 43, alpha 1", make_poisson_problem(61, 43, 3, 4), 1, true);
}

TEST(L1Objective, OfLittleNoiseAndOfMuch) {
    compare("little noise", make_poisson_problem(61, 43, 3, 5, {0.1, 0.003, 0.001, 1}), 0.2, true);
    compare("many outliers", make_poisson_problem(61, 43, 3, 6, {0.7, 0.03, 0.1, 10}), 0.2, true);
    compare("no outliers", make_poisson_problem(61, 43, 3, 7, {0.7, 0.1, 0, 0}), 0.2, true);
}

TEST(L1Objective, OfLines) {
    // Slow edges are few, and weigh the more the fewer edges there are: the default of 20 reweightings leaves 0.2 % of
    // the objective of 300 edges, and more of that of four.
    const double row = compare("301 x 1", make_poisson_problem(301, 1, 3, 8), 0.2, true, 40);
    const double column = compare("1 x 301", make_poisson_problem(1, 301, 3, 8), 0.2, false, 40);
    compare("2 x 2", make_poisson_problem(2, 2, 3, 8), 0.2, true, 80);
    record_stability({"Reconstruction", "1 x N images: grids that cannot be halved, pixels without neighbours",
                      "301 pixels in a line, L1, 40 reweightings", "solved as any other", objective_excess,
                      excess(std::max(row, column)), allowed - 1});
}

/// The left half is black in all inputs: there residuals are 0 and weights as large as they get.
TEST(L1Objective, OfEmptyRegions) {
    PoissonProblem problem = make_poisson_problem(96, 64, 3, 14);
    for (std::uint32_t c = 0; c < 3; ++c)
        for (std::uint32_t y = 0; y < 64; ++y)
            for (std::uint32_t x = 0; x < 48; ++x)
                for (std::vector<float> *plane : {&problem.primal, &problem.dx, &problem.dy})
                    (*plane)[problem.at(c, x, y)] = 0;
    const double ratio = compare("left half black", problem, 0.2, true);
    const std::vector<float> image = solve(problem, PoissonOptions()).image;
    EXPECT_EQ(count_non_finite(image), 0u);
    double largest = 0; // more than two pixels away from the other half
    for (std::uint32_t c = 0; c < 3; ++c)
        for (std::uint32_t y = 0; y < 64; ++y)
            for (std::uint32_t x = 0; x < 46; ++x)
                largest = worse(largest, double(std::abs(image[problem.at(c, x, y)])));
    constexpr const char *failure = "L1 with empty regions: residuals of 0 have weights without bound";
    constexpr const char *provoked_by = "an image whose left half is black in all inputs";
    record_stability({"Reconstruction", failure, provoked_by, "weights are bounded, the system preconditioned",
                      objective_excess, excess(ratio), allowed - 1});
    record_stability({"Reconstruction", failure, provoked_by, "what is black stays black",
                      "largest value in the black half, 2 pixels from the other", largest, 1e-3});
}

/// How near the least objective of all the solution is, where that can be told.
TEST(L1Objective, IsNearTheLeast) {
    for (const bool joint : {true, false}) {
        const PoissonProblem problem = make_poisson_problem(24, 17, 3, 9);
        PoissonOptions options = plain_l1_options();
        options.joint_channels = joint;
        const double objective = l1_objective(problem, 0.2, to_double(solve(problem, options).image), joint);
        const Bracket bracket = bracket_least_l1(problem, 0.2, joint);
        std::printf("joint %d: objective %.6g, the least is between %.6g and %.6g (%+.3f %%)\n", joint, objective,
                    bracket.least, bracket.most, 100 * (objective / bracket.most - 1));
        EXPECT_GE(objective, bracket.least * (1 - 1e-6));
        EXPECT_LE(objective, bracket.most * 1.01);
    }
}

TEST(L1Objective, IsNothingForExactInputs) {
    const PoissonProblem problem = make_exact_problem(129, 65, 3);
    const std::vector<float> zeros(problem.primal.size());
    HostImages images = problem.images();
    PoissonSolver &solver = solver_for(problem);
    EXPECT_LE(relative_error(solve(solver, images, PoissonOptions()).image, to_double(problem.clean)), 1e-6);
    images.start = zeros.data();
    for (const bool keep_mean : {false, true}) {
        PoissonOptions options;
        options.keep_mean = keep_mean;
        EXPECT_LE(relative_error(solve(solver, images, options).image, to_double(problem.clean)), 1e-6)
            << "from zero, keep_mean " << keep_mean;
    }
}

/// As for L2: no constant of the reweighting has a unit. Where equations have no residual their weights are large and
/// tell rounding errors apart, so pixels differ by more than rounding; the objective does not.
TEST(L1Objective, ScaleDoesNotMatter) {
    const PoissonProblem problem = make_poisson_problem(75, 43, 3, 10);
    const Solution expected = solve(problem, PoissonOptions());
    for (const int exponent : {-30, -10, 10, 30}) {
        PoissonProblem scaled = problem;
        for (std::vector<float> *plane : {&scaled.primal, &scaled.dx, &scaled.dy})
            for (float &value : *plane)
                value = std::ldexp(value, exponent);
        Solution solution = solve(scaled, PoissonOptions());
        for (float &value : solution.image)
            value = std::ldexp(value, -exponent);
        EXPECT_EQ(solution.report.reweightings, expected.report.reweightings) << "times 2^" << exponent;
        EXPECT_NEAR(std::ldexp(solution.report.objective, -exponent) / expected.report.objective, 1, 1e-6);
        EXPECT_LE(relative_error(solution.image, to_double(expected.image)), 1e-3) << "times 2^" << exponent;
    }
}

TEST(L1Objective, LargeAlphaGivesThePrimal) {
    const PoissonProblem problem = make_poisson_problem(75, 43, 3, 11);
    double worst = 0;
    for (const double alpha : {1e2, 1e6, 1e15}) {
        // Above alpha = 4 no sum of four differences outweighs the primal: I0 is the solution, exactly.
        const Solution solution = solve(problem, plain_l1_options(alpha));
        worst = worse(worst, relative_error(solution.image, to_double(problem.primal)));
    }
    record_stability({"Reconstruction", "alpha to infinity: squares overflow", "alpha from 100 to 1e15, L1",
                      "returns the primal", "relative distance from the primal", worst, 1e-3});
}

/// Outliers of I0 whose differences, four, or three at an edge, weigh less than they do stay; others do not. Where the
/// rest has no residual, what is left is the least.
TEST(L1Objective, OutliersOfThePrimalStayWhereTheyWeighMore) {
    constexpr std::uint32_t size = 32;
    PoissonProblem problem = make_exact_problem(size, size, 3);
    problem.primal.assign(problem.primal.size(), 0.5f);
    problem.dx.assign(problem.dx.size(), 0);
    problem.dy.assign(problem.dy.size(), 0);
    const auto add = [&](std::uint32_t x, std::uint32_t y) {
        for (std::uint32_t c = 0; c < 3; ++c)
            problem.primal[problem.at(c, x, y)] += 1;
    };
    add(7, 9);
    add(20, 21);
    const auto objective_of = [&](double alpha) {
        const Solution solution = solve(problem, plain_l1_options(alpha));
        return l1_objective(problem, alpha, to_double(solution.image), true);
    };
    for (const double alpha : {0.5, 2.0, 2.9, 3.5, 5.0, 10.0, 1e3})
        EXPECT_NEAR(objective_of(alpha) / (2 * std::min(alpha, 4.0) * std::sqrt(3.0)), 1, 0.001) << alpha;
    for (float &value : problem.dx)
        value = 1e-3f;
    for (const double alpha : {5.0, 10.0}) {
        // From 4 on it is I0.
        EXPECT_LE(objective_of(alpha), allowed * l1_objective(problem, alpha, to_double(problem.primal), true))
            << alpha;
    }
}

TEST(L1Objective, AlphaOfZeroKeepsTheMean) {
    const PoissonProblem problem = make_poisson_problem(75, 43, 3, 12);
    double worst = 0;
    for (const bool joint : {true, false}) {
        PoissonOptions options = plain_l1_options(0);
        options.joint_channels = joint;
        const Solution solution = solve(problem, options);
        const std::vector<double> expected = means(problem.primal, 3), kept = means(solution.image, 3);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(kept[c] / expected[c], 1, 1e-5);
        const PoissonProblem &p = problem;
        worst = worse(worst, l1_objective(p, 0, to_double(solution.image), joint) /
                                 l1_objective(p, 0, solve_l1(p, 1e-4, joint), joint));
    }
    record_stability({"Reconstruction", "alpha to 0: the system is singular", "alpha 0, L1",
                      "the mean is the primal's, the differences decide the rest", objective_excess, excess(worst),
                      allowed - 1});
}

TEST(L1Objective, EveryInnerMethodGetsThere) {
    const PoissonProblem problem = make_poisson_problem(75, 43, 3, 13);
    const double reference = l1_objective(problem, 0.2, solve_l1(problem, 0.2, true), true);
    for (const LinearMethod method : {LinearMethod::automatic, LinearMethod::pcg, LinearMethod::cg}) {
        PoissonOptions options = plain_l1_options();
        options.method = method;
        if (method == LinearMethod::cg)
            options.inner_iterations = 20;
        const Solution solution = solve(problem, options);
        const double objective = l1_objective(problem, 0.2, to_double(solution.image), true);
        std::printf("%s: %+.3f %%\n", solution.report.method.c_str(), 100 * (objective / reference - 1));
        EXPECT_LE(objective, allowed * reference) << method_name(method);
    }
}

} // namespace
} // namespace gradus::testing
