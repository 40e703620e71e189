// Weights and alpha from variances.
#include "runtime/error.h"
#include "tests/solver/solver_fixture.h"

namespace gradus::testing {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();

/// The mean of a power of the variances of the equations that there are, all channels together, to one over that power.
class Mean {
  public:
    explicit Mean(double power) : power_(power) {}
    Mean &add(const std::vector<float> &variance, const std::vector<double> &unit) {
        for (std::size_t i = 0; i < variance.size(); ++i) {
            sum_ += unit[i] > 0 ? std::pow(variance[i], power_) : 0;
            count_ += unit[i];
        }
        return *this;
    }
    double value() const { return std::pow(sum_ / count_, 1 / power_); }

  private:
    double power_, sum_ = 0, count_ = 0;
};
constexpr double of_weights = 0.25; ///< their scale's power

double mean_of_primal(const PoissonProblem &problem, double power) {
    return Mean(power).add(problem.primal_variance, unit_weights(problem).primal).value();
}

double mean_of_gradients(const PoissonProblem &problem, double power) {
    const PoissonWeights units = unit_weights(problem);
    return Mean(power).add(problem.dx_variance, units.dx).add(problem.dy_variance, units.dy).value();
}

/// The mean over the channels, for all of them.
void share(std::vector<float> &variance, std::size_t pixels) {
    const std::size_t channels = variance.size() / pixels;
    for (std::size_t i = 0; i < pixels; ++i) {
        double sum = 0;
        for (std::size_t c = 0; c < channels; ++c)
            sum += variance[c * pixels + i];
        for (std::size_t c = 0; c < channels; ++c)
            variance[c * pixels + i] = float(sum / double(channels));
    }
}

/// Scale over variance, with a hundredth of the scale added to the latter. Both differences share one, or one would
/// count for more than the other. With `joint`, all channels of a pixel share their weights.
PoissonWeights inverse_variances(PoissonProblem problem, bool joint) {
    PoissonWeights weights = unit_weights(problem);
    const double primal = mean_of_primal(problem, of_weights), gradient = mean_of_gradients(problem, of_weights);
    if (joint)
        for (std::vector<float> *variance : {&problem.primal_variance, &problem.dx_variance, &problem.dy_variance})
            share(*variance, problem.pixels());
    for (std::size_t i = 0; i < weights.primal.size(); ++i) {
        weights.primal[i] *= primal / (problem.primal_variance[i] + 0.01 * primal);
        weights.dx[i] *= gradient / (problem.dx_variance[i] + 0.01 * gradient);
        weights.dy[i] *= gradient / (problem.dy_variance[i] + 0.01 * gradient);
    }
    return weights;
}

PoissonOptions weighted_options(LinearMethod method = LinearMethod::automatic, double tolerance = 1e-6) {
    PoissonOptions options = l2_options(method, 0.2, tolerance);
    options.weigh_by_variance = true;
    return options;
}

Solution solve_with_variances(const PoissonProblem &problem, const PoissonOptions &options) {
    PoissonSolver &solver = solver_for(problem);
    return solve(solver, problem.images_with_variances(), options);
}

class Variances : public ::testing::TestWithParam<LinearMethod> {};

/// Jacobi's method takes too many steps where some weights are small, unless alpha is large.
TEST_P(Variances, WeighEquationsAsInTheReference) {
    for (const bool joint : {true, false})
        for (const auto &[width, height] : {std::pair{75u, 43u}, {1u, 301u}, {301u, 1u}}) {
            const PoissonProblem problem = make_poisson_problem(width, height, 3, 1);
            const PoissonWeights weights = inverse_variances(problem, joint);
            PoissonOptions options = weighted_options(GetParam());
            options.joint_channels = joint;
            options.alpha = GetParam() == LinearMethod::jacobi ? 2 : 0.2;
            options.iterations = GetParam() == LinearMethod::cg ? 20'000 : 0; // unconditioned
            const std::vector<double> reference =
                solve_weighted(problem, options.alpha, weights, to_double(problem.primal), 20000, 1e-13);
            const Solution solution = solve_with_variances(problem, options);
            EXPECT_LE(relative_error(solution.image, reference), 1e-3) << width << " x " << height << ", " << joint;
            EXPECT_NEAR(relative_residual(problem, options.alpha, weights, to_double(solution.image)),
                        solution.report.residuals.back(), 1e-6)
                << width << " x " << height << ", " << joint;
        }
}

INSTANTIATE_TEST_SUITE_P(Solver, Variances, ::testing::ValuesIn(linear_methods), method_parameter_name);

TEST(VariancesWeights, OfEqualVariancesAreThePlainSolution) {
    PoissonProblem problem = make_poisson_problem(75, 43, 3, 2);
    problem.primal_variance.assign(problem.primal.size(), 3.0f);
    problem.dx_variance.assign(problem.primal.size(), 0.25f);
    problem.dy_variance.assign(problem.primal.size(), 0.25f);
    EXPECT_LE(relative_error(solve_with_variances(problem, weighted_options()).image, solve_directly(problem, 0.2)),
              1e-4);
}

TEST(VariancesWeights, DoNotDependOnTheUnit) {
    PoissonProblem problem = make_poisson_problem(75, 43, 3, 3);
    const Solution expected = solve_with_variances(problem, weighted_options());
    for (std::vector<float> *plane : {&problem.primal_variance, &problem.dx_variance, &problem.dy_variance})
        for (float &value : *plane)
            value *= 1024;
    EXPECT_LE(relative_error(solve_with_variances(problem, weighted_options()).image, to_double(expected.image)), 1e-6);
}

TEST(VariancesWeights, LessenTheError) {
    const PoissonProblem problem = make_poisson_problem(129, 65, 3, 4);
    PoissonOptions plain = l2_options(LinearMethod::automatic), weighted = weighted_options();
    plain.alpha_from_variances = weighted.alpha_from_variances = true;
    const std::vector<double> clean = to_double(problem.clean);
    const double without = relative_error(solve_with_variances(problem, plain).image, clean);
    const double with = relative_error(solve_with_variances(problem, weighted).image, clean);
    std::printf("relative error with equal weights %.4f, by inverse variance %.4f\n", without, with);
    EXPECT_LT(with, 0.8 * without);
}

/// A firefly's variance says nothing of what lies far from it: nor how much others weigh, nor when a solve may stop.
TEST(VariancesWeights, OfAFireflyAreNotThoseOfTheImage) {
    PoissonProblem problem = make_jumping_problem(129, 97, 3, 8);
    PoissonOptions options = weighted_options(LinearMethod::automatic, 1e-4);
    options.largest_weight = 1000;
    options.alpha_from_variances = true;
    options.noise_share = 1e-3;
    const auto far_error = [&] {
        const std::vector<float> image = solve_with_variances(problem, options).image;
        double sum = 0;
        for (std::uint32_t c = 0; c < 3; ++c)
            for (std::uint32_t y = 40; y < 97; ++y)
                for (std::uint32_t x = 60; x < 129; ++x)
                    sum += std::pow(double(image[problem.at(c, x, y)]) - problem.clean[problem.at(c, x, y)], 2);
        return sum;
    };
    const double without = far_error();
    for (std::vector<float> *plane : {&problem.primal_variance, &problem.dx_variance, &problem.dy_variance})
        for (std::uint32_t c = 0; c < 3; ++c)
            (*plane)[problem.at(c, 10, 10)] *= 1e9f;
    const double with = far_error();
    std::printf("squared error far from it: %.3g, without it %.3g\n", with, without);
    EXPECT_NEAR(with / without, 1, 0.02);
}

/// L1 leaves outliers where they are: how far it trusts all others is not for them to say. L2's squared error is most
/// of all in them.
TEST(VariancesWeights, OfAFireflyDecideTheAlphaOfL2Alone) {
    PoissonProblem problem = make_jumping_problem(129, 97, 3, 8);
    PoissonOptions l1, l2 = l2_options(LinearMethod::automatic);
    l1.alpha_from_variances = l2.alpha_from_variances = true;
    const auto alpha = [&](const PoissonOptions &options) {
        return solve_with_variances(problem, options).report.alpha;
    };
    const double l1_without = alpha(l1), l2_without = alpha(l2);
    problem.dx_variance[problem.at(0, 10, 10)] *= 1e9f;
    EXPECT_NEAR(alpha(l1) / l1_without, 1, 0.02);
    EXPECT_GT(alpha(l2) / l2_without, 10);
}

// Missing ones say nothing, and so not that nothing varies.
TEST(VariancesWeights, AlphaGoesByTheVariancesThatAreThere) {
    PoissonProblem problem = make_poisson_problem(75, 43, 3, 6);
    problem.primal_variance.assign(problem.primal.size(), 4.0f);
    problem.dx_variance.assign(problem.primal.size(), 1.0f);
    problem.dy_variance.assign(problem.primal.size(), 1.0f);
    PoissonOptions options = l2_options(LinearMethod::automatic);
    options.alpha_from_variances = true;
    EXPECT_NEAR(solve_with_variances(problem, options).report.alpha, 0.5, 1e-6);
    const float none[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -1};
    for (std::size_t i = 0; i < problem.primal.size(); i += 2)
        problem.primal_variance[i] = none[i % 3];
    EXPECT_NEAR(solve_with_variances(problem, options).report.alpha, 0.5, 1e-6);
    for (std::size_t i = 1; i < problem.primal.size(); i += 3)
        problem.dx_variance[i] = none[i % 3];
    EXPECT_NEAR(solve_with_variances(problem, options).report.alpha, 0.5, 1e-6);
}

TEST(VariancesWeights, ThatJumpTakeFewSteps) {
    const PoissonProblem problem = make_jumping_problem(513, 301, 3, 7);
    PoissonOptions options = weighted_options(LinearMethod::automatic, 1e-4);
    options.largest_weight = 1000;
    options.alpha_from_variances = true;
    const PoissonReport report = solve_with_variances(problem, options).report;
    std::printf("%d steps\n", report.iterations);
    EXPECT_TRUE(report.converged);
    EXPECT_LE(report.iterations, 17); // with one step of smoothing on the way up 19, without 30
}

/// <e, A e> of the error that is left is by how much the objective is above the least one.
TEST(VariancesWeights, StopWhereTheErrorIsSmallBesideTheNoise) {
    PoissonProblem problem = make_jumping_problem(513, 301, 3, 7);
    PoissonOptions options = weighted_options(LinearMethod::automatic, 1e-6);
    options.largest_weight = 1000;
    options.alpha_from_variances = true;
    const PoissonReport exact = solve_with_variances(problem, options).report;
    const double noise = mean_of_gradients(problem, of_weights) * double(problem.primal.size());
    int before = 0;
    for (const double share : {1e-1, 1e-2, 1e-3}) {
        options.noise_share = share;
        const PoissonReport report = solve_with_variances(problem, options).report;
        const double left = (report.objective - exact.objective) / noise;
        std::printf("%g of the noise: %d steps leave %.2g\n", share, report.iterations, left);
        EXPECT_TRUE(report.converged);
        EXPECT_LE(left, 4 * share) << "weights jump by a thousand";
        EXPECT_GE(left, share / 50) << "so much was not asked for";
        EXPECT_LE(report.residuals.back(), std::sqrt(share));
        EXPECT_EQ(report.residuals.size(), std::size_t(report.iterations)) << "the error before each step";
        EXPECT_GT(report.iterations, before);
        EXPECT_LT(report.iterations, exact.iterations);
        before = report.iterations;
    }
    for (std::vector<float> *plane : {&problem.primal, &problem.dx, &problem.dy})
        for (float &value : *plane)
            value *= 1024;
    for (std::vector<float> *plane : {&problem.primal_variance, &problem.dx_variance, &problem.dy_variance})
        for (float &value : *plane)
            value *= 1024 * 1024;
    EXPECT_EQ(solve_with_variances(problem, options).report.iterations, before) << "in another unit";
}

/// Without noise, the residual tells.
TEST(VariancesWeights, StopByTheResidualWhereNothingIsNoisy) {
    PoissonProblem problem = make_poisson_problem(75, 43, 3, 2);
    for (std::vector<float> *plane : {&problem.primal_variance, &problem.dx_variance, &problem.dy_variance})
        plane->assign(plane->size(), 0.0f);
    PoissonOptions options = weighted_options(LinearMethod::automatic, 1e-5);
    options.alpha_from_variances = true;
    const Solution expected = solve_with_variances(problem, options);
    options.noise_share = 1e-1;
    EXPECT_EQ(solve_with_variances(problem, options).image, expected.image);
}

TEST(VariancesAlpha, IsTheirRatio) {
    const PoissonProblem problem = make_poisson_problem(75, 43, 3, 5);
    for (const PoissonNorm norm : {PoissonNorm::l1, PoissonNorm::l2}) {
        const double power = norm == PoissonNorm::l1 ? 0.25 : 1;
        const double expected = std::sqrt(mean_of_gradients(problem, power) / mean_of_primal(problem, power));
        PoissonOptions options;
        options.norm = norm;
        options.alpha = 77;
        options.alpha_from_variances = true;
        const Solution solution = solve_with_variances(problem, options);
        EXPECT_NEAR(solution.report.alpha / expected, 1, 1e-5);
        if (norm == PoissonNorm::l2) {
            EXPECT_LE(relative_error(solution.image, solve_directly(problem, expected)), 1e-3);
        }
    }
}

/// As those of one sample are. Where the primal's alone are, it is trusted as much as the differences.
TEST(VariancesAlpha, IsAsGivenWhereAllAreZero) {
    PoissonProblem problem = make_poisson_problem(75, 43, 3, 5);
    PoissonOptions options;
    options.alpha_from_variances = true;
    std::fill(problem.primal_variance.begin(), problem.primal_variance.end(), 0.0f);
    EXPECT_EQ(solve_with_variances(problem, options).report.alpha, 1);
    for (std::vector<float> *plane : {&problem.dx_variance, &problem.dy_variance})
        std::fill(plane->begin(), plane->end(), 0.0f);
    options.alpha = 0.3;
    EXPECT_EQ(solve_with_variances(problem, options).report.alpha, 0.3);
}

/// Variances that no estimate has: they are refused or lead to a finite image, and an infinite one to no more weight
/// than a missing input has.
TEST(VariancesThatAreOdd, DoNotSpread) {
    const PoissonProblem problem = make_poisson_problem(75, 43, 3, 6);
    const auto with_odd = [&](float value, bool everywhere) {
        PoissonProblem odd = problem;
        for (std::vector<float> *plane : {&odd.primal_variance, &odd.dx_variance, &odd.dy_variance})
            if (everywhere)
                plane->assign(plane->size(), value);
            else
                for (std::uint32_t c = 0; c < 3; ++c)
                    (*plane)[odd.at(c, 30, 20)] = value;
        return odd;
    };
    for (const float value : {0.0f, -1.0f, nan, infinity, 1e-38f, 1e38f})
        for (const bool everywhere : {false, true})
            for (const bool choose_alpha : {false, true}) {
                PoissonOptions options = weighted_options();
                options.alpha_from_variances = choose_alpha;
                try {
                    const Solution solution = solve_with_variances(with_odd(value, everywhere), options);
                    EXPECT_EQ(count_non_finite(solution.image), 0u)
                        << value << ", everywhere " << everywhere << ", alpha chosen " << choose_alpha;
                    EXPECT_TRUE(std::isfinite(solution.report.alpha));
                    // Of a noise whose values stay below 60; nothing may run away.
                    EXPECT_LE(norm(to_double(solution.image)), 2 * norm(to_double(problem.primal)))
                        << value << ", everywhere " << everywhere << ", alpha chosen " << choose_alpha;
                } catch (const Error &error) {
                    EXPECT_EQ(error.code, ExitCode::usage) << value;
                    EXPECT_TRUE(everywhere) << value << " at one pixel: " << error.what();
                }
            }
}

} // namespace
} // namespace gradus::testing
