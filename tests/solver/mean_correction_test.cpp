// L1 takes the median where L2 takes the mean, so skewed noise costs it energy; the correction brings local means back.
#include "tests/solver/solver_fixture.h"
#include "tests/support/stability.h"
#include "tests/support/worse.h"

#include <random>

namespace gradus::testing {
namespace {

constexpr std::uint32_t width = 160, height = 128, block = 32;

/// Most samples of the primal are too dark and a twelfth makes up for it, as where light is found by chance.
PoissonProblem skewed_problem(std::uint64_t seed) {
    constexpr int rarity = 12;
    PoissonProblem problem = make_poisson_problem(width, height, 3, seed, {0, 0.02, 0, 0});
    std::mt19937_64 random(seed);
    for (std::size_t pixel = 0; pixel < problem.pixels(); ++pixel) {
        const float factor = random() % rarity == 0 ? 0.6f + 0.4f * rarity : 0.6f;
        for (std::uint32_t c = 0; c < 3; ++c)
            problem.primal[c * problem.pixels() + pixel] = factor * problem.clean[c * problem.pixels() + pixel];
    }
    return problem;
}

/// The means of blocks of 32 x 32, channel by channel.
std::vector<double> block_means(const std::vector<float> &image) {
    std::vector<double> sums(3 * (width / block) * (height / block));
    for (std::uint32_t c = 0; c < 3; ++c)
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x)
                sums[(c * (height / block) + y / block) * (width / block) + x / block] +=
                    image[(std::size_t(c) * height + y) * width + x] / double(block * block);
    return sums;
}

/// Root mean square over blocks of how much an image's mean is off the primal's, relatively.
double block_deviation(const PoissonProblem &problem, const std::vector<float> &image) {
    const std::vector<double> expected = block_means(problem.primal), found = block_means(image);
    double squares = 0;
    for (std::size_t i = 0; i < expected.size(); ++i)
        squares += std::pow(found[i] / expected[i] - 1, 2);
    return std::sqrt(squares / double(expected.size()));
}

double relative_mse(const std::vector<float> &image, const std::vector<float> &clean) {
    double sum = 0;
    for (std::size_t i = 0; i < image.size(); ++i)
        sum += std::pow(double(image[i]) - clean[i], 2) / (double(clean[i]) * clean[i] + 1e-3);
    return sum / double(image.size());
}

struct Pair {
    Solution plain, corrected;
};

Pair solve_both(const PoissonProblem &problem) {
    PoissonSolver &solver = solver_for(problem);
    return {solve(solver, problem.images(), plain_l1_options()), solve(solver, problem.images(), PoissonOptions())};
}

TEST(MeanCorrection, BringsBackTheEnergyThatL1Loses) {
    const PoissonProblem problem = skewed_problem(1);
    const auto [plain, corrected] = solve_both(problem);
    const double before = block_deviation(problem, plain.image), after = block_deviation(problem, corrected.image);
    const std::vector<double> expected = means(problem.primal, 3), without = means(plain.image, 3),
                              with = means(corrected.image, 3);
    std::printf("block means off by %.3f without correction, by %.3f with it; whole image %+.3f, %+.3f; relMSE %.4f, "
                "%.4f\n",
                before, after, without[0] / expected[0] - 1, with[0] / expected[0] - 1,
                relative_mse(plain.image, problem.clean), relative_mse(corrected.image, problem.clean));
    EXPECT_GT(before, 0.2) << "the noise is not as skewed as the test needs it";
    record_stability({"Reconstruction", "energy: L1 takes medians, which loses light where noise is skewed",
                      "a primal too dark in eleven of twelve pixels", "adds what local means lack",
                      "how far means of 32 x 32 pixels are off, over that without the correction", after / before,
                      0.25});
    EXPECT_LT(relative_mse(corrected.image, problem.clean), relative_mse(plain.image, problem.clean));
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(with[c] / expected[c], 1, 0.02);
        EXPECT_NEAR(corrected.report.correction[c], with[c] - without[c], 1e-5 * expected[c]);
    }
}

/// Where nothing is lost the correction adds some of the primal's noise. Stated: at most a tenth of the error.
TEST(MeanCorrection, CostsLittleWhereNothingIsLost) {
    for (const double noise : {0.2, 0.7}) {
        const PoissonProblem problem = make_poisson_problem(width, height, 3, 2, {noise, 0.03, 0.01, 2});
        const auto [plain, corrected] = solve_both(problem);
        const double without = relative_mse(plain.image, problem.clean),
                     with = relative_mse(corrected.image, problem.clean);
        std::printf("noise %.1f: relMSE %.5f without correction, %.5f with it\n", noise, without, with);
        EXPECT_LE(with, 1.1 * without);
    }
}

TEST(MeanCorrection, IsNothingForExactInputs) {
    const PoissonProblem problem = make_exact_problem(width, height, 3);
    const Solution solution = solve(problem, PoissonOptions());
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(solution.report.correction[c], 0, 1e-6);
}

/// The correction is clamped against outliers: with a firefly of 1e6 it may change a little around it, and next to
/// nothing far away. There the root mean square counts: single pixels differ by how far reweighting has come.
TEST(MeanCorrection, KeepsAFireflyLocal) {
    double worst = 0;
    for (const std::uint64_t seed : {3u, 4u}) {
        PoissonProblem problem = seed == 3 ? skewed_problem(seed) : make_poisson_problem(width, height, 3, seed);
        PoissonSolver &solver = solver_for(problem);
        const Solution before = solve(solver, problem.images(), PoissonOptions());
        for (std::uint32_t c = 0; c < 3; ++c)
            problem.primal[problem.at(c, 70, 50)] = 1e6f;
        const Solution after = solve(solver, problem.images(), PoissonOptions());
        double far = 0, near = 0, far_count = 0;
        for (std::uint32_t c = 0; c < 3; ++c)
            for (std::uint32_t y = 0; y < height; ++y)
                for (std::uint32_t x = 0; x < width; ++x) {
                    const std::size_t i = problem.at(c, x, y);
                    const double change = std::abs(after.image[i] - before.image[i]) / (problem.clean[i] + 0.03);
                    if (std::hypot(x - 70.0, y - 50.0) > 64) {
                        far += change * change;
                        far_count += 1;
                    } else {
                        near = worse(near, change);
                    }
                }
        far = std::sqrt(far / far_count);
        std::printf("a firefly of 1e6 changes pixels by at most %.3f of their value, and by %.5f (rms) beyond 64"
                    " pixels\n",
                    near, far);
        EXPECT_LE(near, 0.5);
        worst = worse(worst, far);
    }
    record_stability({"Reconstruction", "outliers: one value off by far decides many pixels",
                      "a firefly of 1e6 in the primal, L1 with the correction of the mean",
                      "the correction is clamped by blocks",
                      "change beyond 64 pixels, root mean square relative to the "
                      "image",
                      worst, 0.01});
}

TEST(MeanCorrection, TakesNothingFromMissingPixels) {
    PoissonProblem problem = skewed_problem(5);
    for (std::uint32_t y = 40; y < 60; ++y)
        for (std::uint32_t x = 40; x < 60; ++x)
            problem.primal[problem.at(1, x, y)] = std::numeric_limits<float>::quiet_NaN();
    const auto [plain, corrected] = solve_both(problem);
    EXPECT_EQ(count_non_finite(corrected.image), 0u);
    EXPECT_LT(relative_mse(corrected.image, problem.clean), relative_mse(plain.image, problem.clean));
}

/// As of a render that ends in its first frame: what is there is brought back as far as in an image of nothing else. Of
/// rows beside what is missing, by a hundredth: some steps of a linear solver differ.
TEST(MeanCorrection, BringsBackWhatIsBesideMissingRows) {
    constexpr std::uint32_t rows = 64;
    const PoissonProblem whole = skewed_problem(6);
    PoissonProblem missing = whole, cut = whole;
    cut.height = rows;
    const auto each = [&](auto work) {
        for (auto member : {&PoissonProblem::primal, &PoissonProblem::dx, &PoissonProblem::dy})
            for (std::uint32_t c = 0; c < 3; ++c)
                for (std::uint32_t y = 0; y < height; ++y)
                    for (std::uint32_t x = 0; x < width; ++x)
                        work(member, c, x, y);
    };
    each([&](auto member, std::uint32_t c, std::uint32_t x, std::uint32_t y) {
        const bool is_last_dy = member == &PoissonProblem::dy && y + 1 == rows;
        if (y >= rows || is_last_dy)
            (missing.*member)[whole.at(c, x, y)] = std::numeric_limits<float>::quiet_NaN();
        if (y < rows)
            (cut.*member)[cut.at(c, x, y)] = is_last_dy ? 0 : (whole.*member)[whole.at(c, x, y)];
    });
    const Pair of_missing = solve_both(missing), of_cut = solve_both(cut);
    const auto brightness = [&](const PoissonProblem &problem, const Solution &solution) {
        double sum = 0;
        for (std::uint32_t c = 0; c < 3; ++c)
            for (std::uint32_t y = rows - 8; y < rows; ++y)
                for (std::uint32_t x = 0; x < width; ++x)
                    sum += solution.image[problem.at(c, x, y)];
        return sum;
    };
    const double expected = brightness(cut, of_cut.corrected);
    EXPECT_LT(brightness(cut, of_cut.plain), 0.9 * expected) << "there is to be a loss";
    EXPECT_NEAR(brightness(missing, of_missing.corrected) / expected, 1, 0.01);
}

TEST(MeanCorrection, OfTinyImages) {
    for (const auto &[w, h] : {std::pair{1u, 1u}, {2u, 1u}, {1u, 40u}, {33u, 1u}, {31u, 33u}}) {
        const PoissonProblem problem = make_poisson_problem(w, h, 3, 6);
        EXPECT_EQ(count_non_finite(solve(problem, PoissonOptions()).image), 0u) << w << " x " << h;
    }
}

} // namespace
} // namespace gradus::testing
