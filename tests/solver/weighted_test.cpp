// Two halves that judge each other: weights from the other half's variances.
#include "solver/brightness.h"
#include "solver/weighted_reconstruction.h"
#include "tests/solver/solver_fixture.h"
#include "tests/support/stability.h"
#include "tests/support/worse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <tuple>

namespace gradus::testing {
namespace {

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

/// A half on the host.
struct HostHalf {
    std::vector<float> primal, dx, dy, primal_variance, dx_variance, dy_variance;

    HostImages images() const {
        HostImages images;
        images.primal = primal.data();
        images.dx = dx.data();
        images.dy = dy.data();
        images.primal_variance = primal_variance.data();
        images.dx_variance = dx_variance.data();
        images.dy_variance = dy_variance.data();
        return images;
    }
    HalfImages uploaded(std::uint64_t samples) const {
        const auto buffer = [](const char *name, const std::vector<float> &values) {
            return Buffer(test_device(), name, values.data(), values.size() * sizeof(float));
        };
        return {buffer("primal", primal),
                buffer("dx", dx),
                buffer("dy", dy),
                buffer("primal_variance", primal_variance),
                buffer("dx_variance", dx_variance),
                buffer("dy_variance", dy_variance),
                samples};
    }
};

HostHalf half_of(const PoissonProblem &problem) {
    return {problem.primal, problem.dx, problem.dy, problem.primal_variance, problem.dx_variance, problem.dy_variance};
}

std::vector<float> read(const Buffer &buffer) {
    std::vector<float> values(buffer.bytes() / sizeof(float));
    buffer.read(values.data(), buffer.bytes());
    return values;
}

/// The mean over the channels, smoothed as VarianceSmoother says, on the host in double. -1: missing.
std::vector<double> smoothed_on_host(const PoissonProblem &problem, const std::vector<float> &variance,
                                     const std::vector<float> &primal, double samples, std::uint32_t columns,
                                     std::uint32_t rows) {
    const std::size_t pixels = problem.pixels();
    const auto mean_of = [&](const std::vector<float> &packed) {
        std::vector<double> mean(pixels, 0.0);
        for (std::size_t i = 0; i < packed.size(); ++i)
            mean[i % pixels] += packed[i] / double(problem.channels);
        for (double &value : mean)
            value = std::isfinite(value) && std::fabs(value) < 1e20 ? value : -1;
        return mean;
    };
    const auto smooth = [&](const std::vector<double> &image, std::uint32_t w, std::uint32_t h, int apart,
                            double side) {
        std::vector<double> result(pixels, 0.0);
        for (int y = 0; y < int(problem.height); ++y)
            for (int x = 0; x < int(problem.width); ++x) {
                double sum = 0, weight = 0;
                for (int dy = -1; dy <= 1; ++dy)
                    for (int dx = -1; dx <= 1; ++dx) {
                        const int to_x = x + dx * apart, to_y = y + dy * apart;
                        if (to_x < 0 || to_y < 0 || to_x >= int(w) || to_y >= int(h))
                            continue;
                        const double tap = (dx ? side : 1) * (dy ? side : 1);
                        const double value = image[problem.at(0, std::uint32_t(to_x), std::uint32_t(to_y))];
                        sum += value >= 0 ? tap * value : 0;
                        weight += value >= 0 ? tap : 0;
                    }
                result[problem.at(0, std::uint32_t(x), std::uint32_t(y))] = weight > 0 ? sum / weight : -1;
            }
        return result;
    };
    std::vector<double> bright = mean_of(primal);
    for (double &value : bright)
        value = std::fabs(value);
    for (int i = 0; i < 2; ++i)
        bright = smooth(bright, problem.width, problem.height, 1, 0.5);
    std::vector<double> image = mean_of(variance), logarithm(pixels, 0.0);
    double shares = 0;
    const std::array<std::pair<int, double>, 5> widths = {{{1, 0.07}, {1, 0.5}, {2, 0.5}, {4, 0.5}, {8, 0.5}}};
    for (std::size_t k = 0; k < widths.size(); ++k) {
        const std::vector<double> before = image;
        image = smooth(image, columns, rows, widths[k].first, widths[k].second);
        const double share = k == 0 ? 2 * (1 - 1 / samples) : 1;
        for (std::size_t i = 0; i < pixels; ++i) {
            // What is there for the first time counts for all shares so far.
            const double counts = share + (before[i] < 0 ? shares : 0);
            if (image[i] >= 0)
                logarithm[i] += counts * std::log(image[i] + 1e-3 / samples * bright[i] * bright[i] + 1e-30);
        }
        shares += share;
    }
    for (std::size_t i = 0; i < pixels; ++i)
        logarithm[i] = image[i] >= 0 ? std::exp(logarithm[i] / shares) : -1;
    return logarithm;
}

TEST(Weighted, VariancesAreSmoothedAsInTheReference) {
    constexpr double samples = 5;
    // With `holes`: pixels, and a square so large that no smoothing reaches its middle.
    for (const auto &[width, height, holes] :
         {std::tuple{75u, 43u, false}, {75u, 43u, true}, {1u, 33u, false}, {65u, 1u, false}, {1u, 1u, false}}) {
        PoissonProblem problem = make_poisson_problem(width, height, 3, 1);
        for (std::uint32_t y = 0; y < height && holes; ++y)
            for (std::uint32_t x = 0; x < width; ++x)
                if ((x > 30 && x < 66 && y > 3 && y < 39) || x * 7 % 11 + y * 5 % 13 == 3)
                    for (std::vector<float> *variance :
                         {&problem.primal_variance, &problem.dx_variance, &problem.dy_variance})
                        (*variance)[problem.at(x % 3, x, y)] = x % 2 ? not_a_number : -1e30f;
        const HalfImages half = half_of(problem).uploaded(std::uint64_t(samples) * problem.pixels());
        VarianceSmoother smoother(test_device(), width, height, 3);
        smoother.begin(half);
        using Differences = VarianceSmoother::Differences;
        for (const Differences differences : {Differences::none, Differences::right, Differences::down}) {
            const bool right = differences == Differences::right, down = differences == Differences::down;
            const std::uint32_t columns = width - right, rows = height - down;
            if (columns == 0 || rows == 0)
                continue;
            const std::vector<float> &variance = right  ? problem.dx_variance
                                                 : down ? problem.dy_variance
                                                        : problem.primal_variance;
            const Buffer &buffer = right ? half.dx_variance : down ? half.dy_variance : half.primal_variance;
            const std::vector<float> found = read(smoother.smoothed(buffer, differences));
            const std::vector<double> expected =
                smoothed_on_host(problem, variance, problem.primal, samples, columns, rows);
            double worst = 0;
            int missing = 0;
            ASSERT_EQ(found.size(), problem.pixels()) << "one plane";
            for (std::uint32_t y = 0; y < rows; ++y)
                for (std::uint32_t x = 0; x < columns; ++x) {
                    const double right_one = expected[problem.at(0, x, y)];
                    worst = worse(worst, std::fabs(found[problem.at(0, x, y)] / right_one - 1));
                    missing += right_one < 0;
                }
            EXPECT_EQ(missing > 0, holes);
            // -1 is -1. Logarithms of up to 30 in float, and what the sums before them lose: tens of roundings of 30.
            EXPECT_LE(worst, 40 * 30 * rounding) << width << " x " << height;
        }
    }
}

TEST(Weighted, AHalfIsSolvedAsByADenseSolver) {
    for (const auto &[width, height] : {std::pair{41u, 23u}, {1u, 33u}, {65u, 1u}}) {
        const PoissonProblem problem = make_poisson_problem(width, height, 3, 1),
                             other = make_poisson_problem(width, height, 3, 2);
        const HalfImages half = half_of(problem).uploaded(4 * problem.pixels()),
                         judge = half_of(other).uploaded(4 * problem.pixels());
        PoissonSolver &solver = solver_for(problem);
        Buffer result(test_device(), "result", problem.primal.size() * sizeof(float));
        const PoissonReport report = WeightedReconstruction(test_device(), solver).solve_half(half, judge, result);
        EXPECT_TRUE(report.converged);
        // Weights from the other half, smoothed as the test above shows.
        PoissonWeights weights = unit_weights(problem);
        VarianceSmoother smoother(test_device(), width, height, 3);
        smoother.begin(judge);
        const auto weigh = [&](std::vector<double> &weight, const Buffer &variance,
                               VarianceSmoother::Differences differences) {
            const std::vector<float> smoothed = read(smoother.smoothed(variance, differences));
            for (std::size_t i = 0; i < weight.size(); ++i)
                weight[i] *= smoothed[i % problem.pixels()] > 0 ? 1 / smoothed[i % problem.pixels()] : 0;
        };
        weigh(weights.primal, judge.primal_variance, VarianceSmoother::Differences::none);
        weigh(weights.dx, judge.dx_variance, VarianceSmoother::Differences::right);
        weigh(weights.dy, judge.dy_variance, VarianceSmoother::Differences::down);
        const std::vector<double> expected =
            solve_weighted(problem, 1, weights, to_double(problem.primal), 20000, 1e-13);
        // The solver stops where its error is small beside the noise, and bounds weights at a thousand times the
        // mean's.
        EXPECT_LE(relative_error(read(result), expected), 3e-3) << width << " x " << height;
    }
}

/// An image of ones with skewed noise, as light is: most samples are dark, few are bright. Each half has its variances
/// from its own samples.
HostHalf skewed_half(std::uint32_t width, std::uint32_t height, int samples, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const std::size_t values = 3 * std::size_t(width) * height;
    HostHalf half;
    const auto fill = [&](std::vector<float> &mean, std::vector<float> &variance, double level, auto draw) {
        for (std::size_t i = 0; i < values; ++i) {
            double sum = 0, squares = 0;
            for (int k = 0; k < samples; ++k) {
                const double value = draw();
                sum += value;
                squares += value * value;
            }
            sum /= samples;
            mean.push_back(float(level + sum));
            variance.push_back(float(std::max(squares / samples - sum * sum, 0.0) / (samples - 1)));
        }
    };
    // Lognormal, of mean 0 with the level.
    const auto skewed = [&] { return std::exp(normal(random) - 0.5) - 1; };
    const auto even = [&] { return 0.7 * normal(random); };
    fill(half.primal, half.primal_variance, 1, skewed);
    fill(half.dx, half.dx_variance, 0, even);
    fill(half.dy, half.dy_variance, 0, even);
    return half;
}

/// Ones: the primal's noise is skewed, so what is too dark also looks too sure. Weights of the same half therefore
/// darken the image, and those of the other half do not.
TEST(Weighted, IsUnbiasedAndWeightsOfTheSameHalfAreNot) {
    constexpr std::uint32_t side = 192, block = 24, count = side / block;
    PoissonSolver solver(test_device(), side, side, 3);
    WeightedReconstruction weighted(test_device(), solver);
    const HalvedImages halves = {skewed_half(side, side, 4, 1).uploaded(4 * side * side),
                                 skewed_half(side, side, 4, 2).uploaded(4 * side * side)};
    Buffer result(test_device(), "result", 3 * side * side * sizeof(float));
    // Means of blocks far enough apart to be independent but for their borders.
    const auto bias = [&] {
        const std::vector<float> image = read(result);
        double sum = 0, squares = 0;
        for (std::uint32_t b = 0; b < count * count; ++b) {
            double mean = 0;
            for (std::uint32_t c = 0; c < 3; ++c)
                for (std::uint32_t y = 0; y < block; ++y)
                    for (std::uint32_t x = 0; x < block; ++x)
                        mean += (image[(c * side + b / count * block + y) * side + b % count * block + x] - 1) /
                                (3 * block * block);
            sum += mean;
            squares += mean * mean;
        }
        const double n = count * count, mean = sum / n;
        return std::pair{mean, mean / std::sqrt((squares / n - mean * mean) / (n - 1))};
    };
    weighted.solve(halves, result);
    const auto [bias_of_both, z_of_both] = bias();
    weighted.solve_half(halves[0], halves[0], result);
    const auto [bias_of_same, z_of_same] = bias();
    std::printf("bias %.4f (%.1f standard errors); with weights of the same half %.4f (%.1f)\n", bias_of_both,
                z_of_both, bias_of_same, z_of_same);
    // One in 16 000 by chance.
    EXPECT_LE(std::fabs(z_of_both), 4);
    EXPECT_LE(z_of_same, -8) << "the noise is not skewed enough for the test to see a bias";
}

TEST(Weighted, HalvesCountByTheirSamples) {
    const PoissonProblem problem = make_poisson_problem(33, 17, 3, 3), other = make_poisson_problem(33, 17, 3, 4);
    HalvedImages halves = {half_of(problem).uploaded(3 * problem.pixels()),
                           half_of(other).uploaded(2 * problem.pixels())};
    WeightedReconstruction weighted(test_device(), solver_for(problem));
    const std::size_t bytes = problem.primal.size() * sizeof(float);
    Buffer first(test_device(), "first", bytes), second(test_device(), "second", bytes),
        both(test_device(), "b", bytes);
    weighted.solve_half(halves[0], halves[1], first);
    weighted.solve_half(halves[1], halves[0], second);
    weighted.solve(halves, both);
    const std::vector<float> a = read(first), b = read(second), mean = read(both);
    for (std::size_t i = 0; i < a.size(); ++i)
        ASSERT_NEAR(mean[i], 0.6 * a[i] + 0.4 * b[i], 1e-5 * (std::fabs(a[i]) + std::fabs(b[i])));
}

TEST(Weighted, IsTheSameAfterWhatOverflows) {
    const PoissonProblem problem = make_poisson_problem(43, 17, 3, 3), other = make_poisson_problem(43, 17, 3, 4);
    const HalvedImages halves = {half_of(problem).uploaded(2 * problem.pixels()),
                                 half_of(other).uploaded(2 * problem.pixels())};
    PoissonProblem huge = problem;
    for (std::vector<float> *plane : {&huge.primal, &huge.dx, &huge.dy, &huge.primal_variance, &huge.dx_variance})
        for (float &value : *plane)
            value = value < 0 ? -3e38f : 3e38f;
    const HalvedImages of_huge = {half_of(huge).uploaded(problem.pixels()), half_of(huge).uploaded(problem.pixels())};
    WeightedReconstruction weighted(test_device(), solver_for(problem));
    Buffer result(test_device(), "result", problem.primal.size() * sizeof(float));
    const auto solved = [&](const HalvedImages &images) {
        weighted.solve(images, result);
        return read(result);
    };
    const std::vector<float> before = solved(halves);
    EXPECT_GT(count_non_finite(solved(of_huge)), 0u) << "nothing overflows, and this test sees nothing";
    EXPECT_EQ(before, solved(halves));
}

/// Pixels that happen to look sure, beside ones that do not, do not hold their neighbours down.
TEST(Weighted, VariancesOfZeroBesideNoisyOnesAreNotTrusted) {
    const PoissonProblem problem = make_poisson_problem(64, 64, 3, 5), other = make_poisson_problem(64, 64, 3, 6);
    HostHalf half = half_of(problem), judge = half_of(other);
    for (std::uint32_t y = 0; y < 64; ++y)
        for (std::uint32_t x = 0; x < 64; ++x)
            for (std::uint32_t c = 0; c < 3 && x % 16 < 2 && y % 16 < 2; ++c) {
                const std::size_t at = problem.at(c, x, y);
                judge.primal_variance[at] = 0;
                half.primal[at] *= 0.2f; // dark by chance
            }
    const std::size_t bytes = problem.primal.size() * sizeof(float);
    Buffer result(test_device(), "result", bytes);
    WeightedReconstruction weighted(test_device(), solver_for(problem));
    const auto error = [&](const HostHalf &judge_of_it) {
        weighted.solve_half(half.uploaded(8 * 4096), judge_of_it.uploaded(8 * 4096), result);
        return relative_error(read(result), to_double(problem.clean));
    };
    const double without = error(half_of(other)), with = error(judge);
    std::printf("relative error %.4f, with variances of zero in squares of 2 pixels: %.4f\n", without, with);
    record_stability({"Reconstruction", "variances of zero beside noisy ones: pixels that look sure, and are not",
                      "squares of 2 pixels too dark by chance whose variance is 0, weights from variances",
                      "variances are smoothed over neighbours before anything is weighed by them",
                      "error over that without such squares", with / without, 1.2});
}

/// Where nothing is seen, as on a lamp whose light is kept apart, all is zero, variances too; beside it there is noise.
TEST(Weighted, BlackRegionsAreNoTrouble) {
    const PoissonProblem problem = make_poisson_problem(64, 64, 3, 9), other = make_poisson_problem(64, 64, 3, 10);
    HostHalf halves[2] = {half_of(problem), half_of(other)};
    std::vector<double> clean = to_double(problem.clean);
    for (std::uint32_t c = 0; c < 3; ++c)
        for (std::uint32_t y = 20; y < 44; ++y)
            for (std::uint32_t x = 20; x < 44; ++x) {
                const std::size_t at = problem.at(c, x, y);
                clean[at] = 0;
                for (HostHalf &half : halves) {
                    half.primal[at] = half.primal_variance[at] = 0;
                    half.dx[at] = x < 43 ? 0 : float(problem.clean[at + 1]);
                    half.dy[at] = y < 43 ? 0 : float(problem.clean[at + 64]);
                    half.dx_variance[at] = half.dy_variance[at] = 0;
                    half.dx[problem.at(c, 19, y)] = -float(problem.clean[problem.at(c, 19, y)]);
                    half.dy[problem.at(c, x, 19)] = -float(problem.clean[problem.at(c, x, 19)]);
                }
            }
    const std::size_t bytes = problem.primal.size() * sizeof(float);
    Buffer result(test_device(), "result", bytes);
    WeightedReconstruction weighted(test_device(), solver_for(problem));
    const PoissonReport report = weighted.solve({halves[0].uploaded(8 * 4096), halves[1].uploaded(8 * 4096)}, result);
    const double error = relative_error(read(result), clean);
    std::printf("relative error with a black square %.4f, %d steps\n", error, report.iterations);
    EXPECT_TRUE(report.converged);
    EXPECT_LE(error, 0.15);
}

TEST(Weighted, WhatIsMissingStaysInItsPlace) {
    const PoissonProblem problem = make_poisson_problem(64, 48, 3, 7), other = make_poisson_problem(64, 48, 3, 8);
    const std::array<std::vector<float> HostHalf::*, 6> planes = {&HostHalf::primal,      &HostHalf::dx,
                                                                  &HostHalf::dy,          &HostHalf::primal_variance,
                                                                  &HostHalf::dx_variance, &HostHalf::dy_variance};
    std::vector<float> clean(problem.primal.size()), result(problem.primal.size());
    const std::array<std::uint64_t, 2> samples = {4 * problem.pixels(), 4 * problem.pixels()};
    const auto solve = [&](const HostHalf &a, const HostHalf &b, std::vector<float> &to) {
        return solve_weighted(test_device(), solver_for(problem), {{a.images(), b.images()}, samples}, to.data());
    };
    solve(half_of(problem), half_of(other), clean);
    for (const auto plane : planes)
        for (const float value : {not_a_number, std::numeric_limits<float>::infinity()}) {
            HostHalf half = half_of(problem);
            (half.*plane)[problem.at(1, 20, 30)] = value;
            const PoissonReport report = solve(half, half_of(other), result);
            EXPECT_EQ(std::count_if(result.begin(), result.end(), [](float v) { return !std::isfinite(v); }), 0);
            EXPECT_LE(relative_error(result, to_double(clean)), 0.05);
            EXPECT_EQ(report.missing_primal, plane == &HostHalf::primal ? 1u : 0u);
        }
    // A whole half without variances, as a judge of nothing: the other's differences and pixels are all left out.
    HostHalf blind = half_of(problem);
    for (const auto plane : {&HostHalf::primal_variance, &HostHalf::dx_variance, &HostHalf::dy_variance})
        std::fill((blind.*plane).begin(), (blind.*plane).end(), not_a_number);
    solve(blind, half_of(other), result);
    EXPECT_EQ(std::count_if(result.begin(), result.end(), [](float v) { return !std::isfinite(v); }), 0);
}

/// Within the brightness that is promised: of an image that is as bright as that on average, and a power of two.
TEST(Weighted, BrightAndDarkImagesHaveTheirWeights) {
    const auto scaled = [](HostHalf half, float factor) {
        for (std::vector<float> *image : {&half.primal, &half.dx, &half.dy})
            for (float &value : *image)
                value *= factor;
        for (std::vector<float> *variances : {&half.primal_variance, &half.dx_variance, &half.dy_variance})
            for (float &value : *variances)
                value *= factor * factor;
        return half;
    };
    for (const auto &[width, height] : {std::pair{40u, 30u}, {320u, 240u}}) { // of many pixels sums of squares overflow
        SCOPED_TRACE(width);
        const HostHalf first = skewed_half(width, height, 8, 1), second = skewed_half(width, height, 8, 2);
        PoissonSolver solver(test_device(), width, height);
        const auto solved = [&](float factor) {
            Buffer result(test_device(), "result", first.primal.size() * sizeof(float));
            const std::uint64_t samples = std::uint64_t(8) * width * height;
            const HalvedImages halves{scaled(first, factor).uploaded(samples),
                                      scaled(second, factor).uploaded(samples)};
            WeightedReconstruction(test_device(), solver).solve(halves, result);
            std::vector<float> image = read(result);
            for (float &value : image)
                value /= factor;
            return image;
        };
        const std::vector<float> usual = solved(1);
        const std::vector<double> expected(usual.begin(), usual.end());
        const auto brightest = float(brightest_mean(first.primal.size()));
        EXPECT_LE(relative_error(solved(std::exp2(std::ceil(std::log2(float(darkest_mean))))), expected), 1e-5);
        EXPECT_LE(relative_error(solved(std::exp2(std::floor(std::log2(brightest)))), expected), 1e-5);
        // Beyond it there is something to tell.
        EXPECT_GT(relative_error(solved(0x1p-60f), expected), 1e-3);
    }
}

TEST(Weighted, SmallAndFlatImagesComeBack) {
    for (const auto &[width, height] : {std::pair{1u, 1u}, {1u, 9u}, {9u, 1u}, {2u, 2u}})
        for (const float value : {0.0f, 1e-12f, 1.0f, 3e7f}) {
            const std::size_t count = 3 * std::size_t(width) * height;
            const std::vector<float> flat(count, value), none(count, 0.0f);
            const HostHalf half = {flat, none, none, none, none, none};
            PoissonSolver solver(test_device(), width, height, 3);
            std::vector<float> result(count, -1.0f);
            solve_weighted(test_device(), solver, {{half.images(), half.images()}, {4, 4}}, result.data());
            for (const float found : result)
                EXPECT_NEAR(found, value, 4 * rounding * value) << width << " x " << height;
        }
}

} // namespace
} // namespace gradus::testing
