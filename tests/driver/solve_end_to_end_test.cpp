// `gradus solve` itself, on small images whose reconstruction is known.
#include "runtime/film/metrics.h"
#include "tests/driver/child_process.h"
#include "tests/driver/gradient_images.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace gradus {
namespace {

using ::testing::HasSubstr;

constexpr std::uint32_t width = 37, height = 23;
constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

/// The difference to the next pixel to the right or below, as a channel; 7 in the last column or row, which is not
/// to be read.
Channel difference(const Channel &channel, std::uint32_t right, std::uint32_t down) {
    Channel result{channel.name, std::vector<float>(channel.values.size(), 7)};
    for (std::uint32_t y = 0; y + down < height; ++y)
        for (std::uint32_t x = 0; x + right < width; ++x)
            result.values[y * width + x] =
                channel.values[(y + down) * width + x + right] - channel.values[y * width + x];
    return result;
}

/// An image with all that a solve reads, and the means to spoil it.
struct Problem {
    Image truth, primal, dx, dy;
};

/// Uniform noise over a step and a ramp, different in each channel. The primal is the truth.
Problem make_problem(const std::vector<std::string> &names) {
    Problem problem;
    std::mt19937 generator(1);
    std::uniform_real_distribution<float> noise(0, 0.5f);
    for (Image *image : {&problem.truth, &problem.dx, &problem.dy}) {
        image->width = width;
        image->height = height;
    }
    for (const std::string &name : names) {
        Channel channel{name, std::vector<float>(width * height)};
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x)
                channel.values[y * width + x] = noise(generator) + (x > 20 ? 2.0f : 0.5f) + 0.03f * float(y);
        problem.dx.channels.push_back(difference(channel, 1, 0));
        problem.dy.channels.push_back(difference(channel, 0, 1));
        problem.truth.channels.push_back(std::move(channel));
    }
    problem.primal = problem.truth;
    return problem;
}

class SolveEndToEnd : public ProgramTest {
  protected:
    void write_files(const Problem &problem) const {
        write_image(problem.primal, at("p.exr"));
        write_image(problem.dx, at("dx.exr"));
        write_image(problem.dy, at("dy.exr"));
    }
    void write_layers(const std::vector<std::pair<std::string, const Image *>> &images) const {
        Image all;
        all.width = width;
        all.height = height;
        for (const auto &[layer, image] : images)
            for (const Channel &channel : image->channels)
                all.channels.push_back({layer + "." + channel.name, channel.values});
        write_image(all, at("layers.exr"));
    }
    /// Solves from p.exr, dx.exr and dy.exr.
    Image solve(std::vector<std::string> options) {
        options.insert(options.begin(), {"solve", "--primal", "p.exr", "--dx", "dx.exr", "--dy", "dy.exr", "-o",
                                         "out.exr", "--stats", "out.json"});
        const Outcome outcome = run(options);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        if (outcome.exit_code != 0)
            return {};
        printed_text = outcome.out;
        statistics = nlohmann::json::parse(text_of("out.json"));
        return read_image(at("out.exr"));
    }
    /// Over pixels and channels; infinite where channels or values are missing.
    static double largest_difference(const Image &image, const Image &expected) {
        double largest = 0;
        for (const Channel &channel : expected.channels) {
            const Channel *other = image.find(channel.name);
            if (!other)
                return infinity;
            for (std::size_t i = 0; i < channel.values.size(); ++i) {
                const double difference = std::abs(double(channel.values[i]) - other->values[i]);
                largest = std::max(largest, std::isfinite(difference) ? difference : infinity);
            }
        }
        return largest;
    }

    /// Root of the mean square over pixels and channels; infinite where channels or values are missing.
    static double mean_difference(const Image &image, const Image &expected) {
        if (!std::isfinite(largest_difference(image, expected)))
            return infinity;
        double sum = 0;
        for (const Channel &channel : expected.channels)
            for (std::size_t i = 0; i < channel.values.size(); ++i) {
                const double difference = double(channel.values[i]) - image.find(channel.name)->values[i];
                sum += difference * difference;
            }
        return std::sqrt(sum / (width * height * double(expected.channels.size())));
    }

    std::string printed_text;
    nlohmann::json statistics;
};

TEST_F(SolveEndToEnd, ConsistentGradientsComeBack) {
    const Problem problem = make_problem({"R", "G", "B"});
    write_files(problem);
    EXPECT_LT(largest_difference(solve({}), problem.truth), 1e-5);
    EXPECT_EQ(statistics.at("norm"), "L1");
}

// A cosine that fits the free borders is an eigenvector of the operator: the solution keeps
// alpha^2 / (alpha^2 + eigenvalue) of it (Lehtinen et al. 2013, eq. 19), and all of the truth. What is left at a
// relative residual r is at most r * eigenvalue / alpha^2 of the wave, as a root of the mean square, for alpha^2 is the
// least eigenvalue of the system. Rounding values of at most 4 adds less than 1e-6.
TEST_F(SolveEndToEnd, EveryMethodDampsAWaveAsTheoryHasIt) {
    Problem problem = make_problem({"R", "G", "B"});
    const double horizontal = std::numbers::pi * 3 / width, vertical = std::numbers::pi * 2 / height, alpha = 0.2;
    const double eigenvalue = 4 - 2 * std::cos(horizontal) - 2 * std::cos(vertical);
    const double kept = alpha * alpha / (alpha * alpha + eigenvalue);
    Image expected = problem.truth;
    for (std::size_t c = 0; c < 3; ++c)
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                const double wave = std::cos(horizontal * (x + 0.5)) * std::cos(vertical * (y + 0.5));
                problem.primal.channels[c].values[y * width + x] += float(wave);
                expected.channels[c].values[y * width + x] += float(kept * wave);
            }
    write_files(problem);
    ASSERT_LT(kept, 0.5) << "the wave must be well damped";
    for (const std::vector<std::string> &options : {std::vector<std::string>{"--method", "auto"},
                                                    {"--method", "jacobi"},
                                                    {"--method", "cg"},
                                                    {"--method", "pcg"},
                                                    {"--method", "multigrid"}}) {
        std::vector<std::string> all{"--norm", "L2"};
        all.insert(all.end(), options.begin(), options.end());
        EXPECT_LT(mean_difference(solve(all), expected), 1e-5 * eigenvalue / (alpha * alpha) * 0.5 + 1e-6)
            << options.back();
        EXPECT_EQ(statistics.at("method"), options.back() == "auto" ? "multigrid" : options.back());
        EXPECT_EQ(statistics.at("converged"), true) << options.back();
        ASSERT_FALSE(statistics.at("residuals").empty()) << options.back();
        EXPECT_LE(statistics.at("residuals").back().get<double>(), 1e-5) << options.back();
        EXPECT_GE(statistics.at("iterations").get<int>(), 1) << options.back();
        EXPECT_FALSE(statistics.at("kernels").empty());
    }
    EXPECT_EQ(statistics.at("alpha"), 0.2);
    EXPECT_EQ(read_image(at("out.exr")).metadata.at("method"), "multigrid");
}

// Differences that are right leave L1 nothing to gain from following a few pixels of the primal that are wrong: a
// median. L2 keeps at least alpha^2 / (alpha^2 + 8) = 0.005 of each, 8 being the largest eigenvalue of the differences.
TEST_F(SolveEndToEnd, FirefliesInThePrimalAreLeftOutByL1) {
    Problem problem = make_problem({"R", "G", "B"});
    for (const std::size_t pixel : {100u, 333u, 700u})
        for (Channel &channel : problem.primal.channels)
            channel.values[pixel] += 1000;
    write_files(problem);
    // The sum is 0.2 * 3 * 1000 * sqrt(3) there, and a pixel that is off by d has it grow by (4 - 0.2) sqrt(3) d: what
    // the last step may gain, 1e-4 of it, is worth 0.016.
    EXPECT_LT(largest_difference(solve({"--norm", "L1", "--no-mean-correction"}), problem.truth), 0.016);
    EXPECT_GT(largest_difference(solve({"--norm", "L2"}), problem.truth), 1);
}

TEST_F(SolveEndToEnd, MissingValuesAreCountedAndDoNotSpread) {
    Problem problem = make_problem({"R", "G", "B"});
    problem.dx.channels[1].values[5 * width + 30] = nan;
    problem.dx.channels[0].values[9 * width + 4] = infinity;
    problem.dy.channels[2].values[11 * width + 17] = nan;
    problem.primal.channels[0].values[6 * width + 6] = nan;
    write_files(problem);
    for (const char *norm : {"L1", "L2"}) {
        const Image image = solve({"--norm", norm});
        EXPECT_EQ(count_non_finite(image), 0u) << norm;
        // What is left says the truth without contradiction, so it comes back even where the primal is missing.
        EXPECT_LT(largest_difference(image, problem.truth), 1e-3) << norm;
        EXPECT_EQ(statistics.at("missing").at("primal"), 1) << norm;
        EXPECT_EQ(statistics.at("missing").at("dx"), 2) << norm;
        EXPECT_EQ(statistics.at("missing").at("dy"), 1) << norm;
        EXPECT_EQ(statistics.at("filled"), 0) << norm;
        EXPECT_THAT(printed_text, HasSubstr("missing      primal 1, dx 2, dy 1; filled 0\n"));
    }
}

TEST_F(SolveEndToEnd, LayersEqualFilesBitForBit) {
    Problem problem = make_problem({"R", "G", "B"});
    for (std::size_t c = 0; c < 3; ++c) // no solution that is known ahead
        std::reverse(problem.primal.channels[c].values.begin(), problem.primal.channels[c].values.end());
    const Image direct = make_problem({"B", "G", "R"}).truth;
    write_files(problem);
    write_image(direct, at("direct.exr"));
    write_layers({{"primal", &problem.primal}, {"dx", &problem.dx}, {"dy", &problem.dy}, {"direct", &direct}});
    const Image without = solve({}), files = solve({"--direct", "direct.exr"});
    ASSERT_EQ(run({"solve", "layers.exr", "-o", "layered.exr", "--nthreads", "1"}).exit_code, 0);
    const Image layered = read_image(at("layered.exr"));
    for (const char *name : {"R", "G", "B"}) {
        EXPECT_EQ(layered.find(name)->values, files.find(name)->values) << name;
        for (std::size_t i = 0; i < width * height; ++i)
            ASSERT_EQ(files.find(name)->values[i], without.find(name)->values[i] + direct.find(name)->values[i]);
    }
}

TEST_F(SolveEndToEnd, AlphaFromVariances) {
    const Problem problem = make_problem({"R", "G", "B"});
    Image primal_variance = problem.truth, dx_variance = problem.truth, dy_variance = problem.truth;
    for (std::size_t c = 0; c < 3; ++c)
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                primal_variance.channels[c].values[y * width + x] = 4;
                // What lies over the border is not to be read.
                dx_variance.channels[c].values[y * width + x] = x + 1 < width ? 0.125f : 1e6f;
                dy_variance.channels[c].values[y * width + x] = y + 1 < height ? 0.375f : 1e6f;
            }
    write_layers({{"primal", &problem.primal},
                  {"dx", &problem.dx},
                  {"dy", &problem.dy},
                  {"primal_variance", &primal_variance},
                  {"dx_variance", &dx_variance},
                  {"dy_variance", &dy_variance}});
    const double across = (width - 1) * height, down = width * (height - 1);
    for (const auto &[norm, power] : {std::pair{"L1", 0.25}, {"L2", 1.0}}) { // outliers do not decide that of L1
        ASSERT_EQ(
            run({"solve", "layers.exr", "-o", "out.exr", "--norm", norm, "--alpha", "auto", "--stats", "out.json"})
                .exit_code,
            0);
        const double mean = (across * std::pow(0.125, power) + down * std::pow(0.375, power)) / (across + down);
        EXPECT_NEAR(nlohmann::json::parse(text_of("out.json")).at("alpha").get<double>(),
                    std::sqrt(std::pow(mean, 1 / power) / 4), 1e-6);
    }
    const Outcome weighted = run({"solve", "layers.exr", "-o", "out.exr", "--norm", "L2", "--weights", "variance"});
    ASSERT_EQ(weighted.exit_code, 0) << weighted.err;
    EXPECT_LT(largest_difference(read_image(at("out.exr")), problem.truth), 1e-5);
}

TEST_F(SolveEndToEnd, GreyImages) {
    const Problem problem = make_problem({"Y"});
    write_files(problem);
    EXPECT_LT(largest_difference(solve({"--norm", "L2", "--png"}), problem.truth), 1e-5);
    EXPECT_EQ(statistics.at("channels"), 1);
    EXPECT_EQ(statistics.at("norm"), "L2");
}

TEST_F(SolveEndToEnd, MistakesLeaveNothing) {
    write_files(make_problem({"R", "G", "B"}));
    const auto before = files();
    const std::vector<std::string> good{"solve", "--primal", "p.exr", "--dx", "dx.exr", "--dy", "dy.exr"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), good.begin(), good.end());
        return run(more);
    };
    EXPECT_EQ(with({"-o", "out.exr", "--device", "no such device"}).exit_code, 4);
    EXPECT_EQ(with({"-o", "out.exr", "--alpha", "-1"}).exit_code, 2);
    EXPECT_EQ(with({"-o", "missing/out.exr"}).exit_code, 5);
    EXPECT_EQ(with({"-o", "out.exr", "--direct", "none.exr"}).exit_code, 6);
    EXPECT_EQ(files(), before);
}

} // namespace
} // namespace gradus
