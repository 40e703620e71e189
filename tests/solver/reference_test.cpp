// The double-precision reference itself, against dense systems written down equation by equation.
#include "tests/support/poisson_reference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace gradus::testing {
namespace {

/// Least squares by Gaussian elimination on the normal equations, one row of the system at a time.
class DenseSystem {
  public:
    explicit DenseSystem(std::size_t unknowns) : n_(unknowns), a_(n_ * n_), b_(n_) {}

    /// Adds weight * (sum of coefficient * unknown - value)^2.
    void add(double weight, const std::vector<std::pair<std::size_t, double>> &terms, double value) {
        for (const auto &[i, p] : terms) {
            for (const auto &[j, q] : terms)
                a_[i * n_ + j] += weight * p * q;
            b_[i] += weight * p * value;
        }
    }
    std::vector<double> solve() {
        for (std::size_t k = 0; k < n_; ++k)
            for (std::size_t i = k + 1; i < n_; ++i) {
                const double factor = a_[i * n_ + k] / a_[k * n_ + k];
                for (std::size_t j = k; j < n_; ++j)
                    a_[i * n_ + j] -= factor * a_[k * n_ + j];
                b_[i] -= factor * b_[k];
            }
        for (std::size_t k = n_; k-- > 0;) {
            for (std::size_t j = k + 1; j < n_; ++j)
                b_[k] -= a_[k * n_ + j] * b_[j];
            b_[k] /= a_[k * n_ + k];
        }
        return b_;
    }

  private:
    std::size_t n_;
    std::vector<double> a_, b_;
};

std::vector<double> solve_densely(const PoissonProblem &p, double alpha, const PoissonWeights &weights) {
    DenseSystem system(p.primal.size());
    for (std::uint32_t c = 0; c < p.channels; ++c)
        for (std::uint32_t y = 0; y < p.height; ++y)
            for (std::uint32_t x = 0; x < p.width; ++x) {
                const std::size_t i = p.at(c, x, y);
                if (weights.primal[i] > 0)
                    system.add(alpha * alpha * weights.primal[i], {{i, 1.0}}, p.primal[i]);
                if (x + 1 < p.width && weights.dx[i] > 0)
                    system.add(weights.dx[i], {{p.at(c, x + 1, y), 1.0}, {i, -1.0}}, p.dx[i]);
                if (y + 1 < p.height && weights.dy[i] > 0)
                    system.add(weights.dy[i], {{p.at(c, x, y + 1), 1.0}, {i, -1.0}}, p.dy[i]);
            }
    return system.solve();
}

/// The same for alpha = 0: one more equation sets the mean of each channel.
std::vector<double> solve_densely_by_mean(const PoissonProblem &p) {
    PoissonProblem one = p;
    std::vector<double> result;
    for (std::uint32_t c = 0; c < p.channels; ++c) {
        DenseSystem system(p.pixels());
        double mean = 0;
        std::vector<std::pair<std::size_t, double>> all;
        for (std::uint32_t y = 0; y < p.height; ++y)
            for (std::uint32_t x = 0; x < p.width; ++x) {
                const std::size_t i = p.at(0, x, y), from = p.at(c, x, y);
                all.emplace_back(i, 1.0);
                mean += p.primal[from];
                if (x + 1 < p.width)
                    system.add(1, {{i + 1, 1.0}, {i, -1.0}}, p.dx[from]);
                if (y + 1 < p.height)
                    system.add(1, {{i + p.width, 1.0}, {i, -1.0}}, p.dy[from]);
            }
        system.add(1, all, mean);
        const std::vector<double> plane = system.solve();
        result.insert(result.end(), plane.begin(), plane.end());
    }
    return result;
}

struct Size {
    std::uint32_t width, height;
};
constexpr Size sizes[] = {{7, 5}, {1, 6}, {8, 1}, {1, 1}, {2, 2}, {4, 9}};

TEST(PoissonReference, DirectSolutionIsTheDenseOne) {
    for (const auto &[width, height] : sizes) {
        const PoissonProblem problem = make_poisson_problem(width, height, 2, 1);
        for (const double alpha : {0.02, 0.2, 2.0})
            EXPECT_LT(
                relative_error(solve_directly(problem, alpha), solve_densely(problem, alpha, unit_weights(problem))),
                1e-11)
                << width << " x " << height << ", alpha " << alpha;
        EXPECT_LT(relative_error(solve_directly(problem, 0), solve_densely_by_mean(problem)), 1e-11)
            << width << " x " << height << ", alpha 0";
    }
}

TEST(PoissonReference, WeightedSolutionIsTheDenseOne) {
    for (const auto &[width, height] : sizes) {
        PoissonProblem problem = make_poisson_problem(width, height, 2, 2);
        // Missing in one channel is missing in both; each pixel keeps an equation.
        problem.dx[problem.pixels() / 2] = std::numeric_limits<float>::quiet_NaN();
        if (problem.pixels() > 1)
            problem.primal[problem.pixels() + problem.pixels() / 3] = std::numeric_limits<float>::infinity();
        PoissonWeights weights = unit_weights(problem);
        EXPECT_EQ(weights.dx[problem.pixels() + problem.pixels() / 2], 0);
        std::mt19937_64 random(3);
        std::uniform_real_distribution<double> exponent(-2, 2);
        for (std::vector<double> *part : {&weights.primal, &weights.dx, &weights.dy})
            for (double &weight : *part)
                weight *= std::pow(10.0, exponent(random));
        EXPECT_LT(relative_error(
                      solve_weighted(problem, 0.2, weights, std::vector<double>(problem.primal.size()), 5000, 1e-14),
                      solve_densely(problem, 0.2, weights)),
                  1e-9)
            << width << " x " << height;
    }
}

TEST(PoissonReference, ObjectivesAreThoseWrittenByHand) {
    PoissonProblem problem;
    problem.width = 2;
    problem.height = 1;
    problem.channels = 2;
    problem.primal = {1, 2, 3, 4};
    problem.dx = {3, 0, 4, 0};
    problem.dy = {0, 0, 0, 0};
    const std::vector<double> image = {1, 1, 3, 3}; // residuals: dx -3 and -4, primal 0 and -1 in both channels
    EXPECT_NEAR(l2_objective(problem, 0.5, image), 9 + 16 + 0.25 * 2, 1e-12);
    EXPECT_NEAR(l1_objective(problem, 0.5, image, false), 3 + 4 + 0.5 * 2, 1e-12);
    EXPECT_NEAR(l1_objective(problem, 0.5, image, true), 5 + 0.5 * std::sqrt(2.0), 1e-12);
}

TEST(PoissonReference, ResidualIsOneAtThePrimalAndNoneAtTheSolution) {
    const PoissonProblem problem = make_poisson_problem(7, 5, 3, 4);
    const PoissonWeights units = unit_weights(problem);
    EXPECT_NEAR(relative_residual(problem, 0.2, units, to_double(problem.primal)), 1, 1e-14);
    EXPECT_LT(relative_residual(problem, 0.2, units, solve_directly(problem, 0.2)), 1e-13);
}

/// The bracket proves itself: both its ends are objectives, one of an image, one of a dual variable. What is left to
/// find is an error in either's formula, by images that would be below it.
TEST(PoissonReference, L1SolutionIsNearTheLeastObjective) {
    for (const Size size : {Size{7, 5}, Size{24, 16}})
        for (const bool joint : {true, false}) {
            const PoissonProblem problem = make_poisson_problem(size.width, size.height, 3, 5);
            const std::vector<double> image = solve_l1(problem, 0.2, joint);
            const double objective = l1_objective(problem, 0.2, image, joint);
            const Bracket bracket = bracket_least_l1(problem, 0.2, joint);
            std::printf("%u x %u, joint %d: between %.6g and %.6g; 60 reweightings %.6g (+%.2g %%)\n", size.width,
                        size.height, joint, bracket.least, bracket.most, objective,
                        100 * (objective / bracket.most - 1));
            EXPECT_LE(bracket.most, bracket.least * (1 + 5e-4));
            EXPECT_GE(objective, bracket.least);
            // Where reg is small before the image has settled, reweighting sticks; it comes to half a per cent.
            EXPECT_LE(objective, bracket.most * 1.005);
            std::mt19937_64 random(6);
            std::normal_distribution<double> normal;
            for (int k = 0; k < 1000; ++k) {
                std::vector<double> other = image;
                for (double &value : other)
                    value += std::pow(10.0, -1 - k % 5) * normal(random);
                EXPECT_LT(bracket.least, l1_objective(problem, 0.2, other, joint));
            }
        }
}

TEST(PoissonReference, L1IgnoresAnOutlierAltogether) {
    PoissonProblem problem = make_exact_problem(7, 5, 3);
    problem.dx[problem.at(1, 3, 2)] += 100;
    EXPECT_LT(relative_error(solve_l1(problem, 0.2, true), to_double(problem.clean)), 1e-5);
}

} // namespace
} // namespace gradus::testing
