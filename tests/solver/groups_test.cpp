// Channels that are solved one after the other, which takes a fraction of the memory, or together; and images that are
// made under way.
#include "runtime/device/opencl.h"
#include "runtime/error.h"
#include "solver/grid.h"
#include "solver/workspace.h"
#include "tests/solver/solver_fixture.h"

#include <array>
#include <functional>
#include <string>
#include <utility>

namespace gradus::testing {
namespace {

/// Channel 1 has nothing to solve, so it is finished long before the others.
PoissonProblem unequal_channels(std::uint32_t width, std::uint32_t height) {
    PoissonProblem problem = make_poisson_problem(width, height, 3, 1);
    for (std::uint32_t y = 0; y < problem.height; ++y)
        for (std::uint32_t x = 0; x < problem.width; ++x) {
            const auto primal = [&](std::uint32_t i, std::uint32_t j) { return problem.primal[problem.at(1, i, j)]; };
            if (x + 1 < problem.width)
                problem.dx[problem.at(1, x, y)] = primal(x + 1, y) - primal(x, y);
            if (y + 1 < problem.height)
                problem.dy[problem.at(1, x, y)] = primal(x, y + 1) - primal(x, y);
        }
    // But for one pixel, so that steps too many change its bits.
    problem.dx[problem.at(1, 7, 9)] += 1e-3f;
    return problem;
}

class Groups : public ::testing::TestWithParam<PoissonOptions> {};

void expect_equal_bits(const PoissonProblem &problem, const PoissonOptions &options) {
    std::vector<Solution> solutions;
    for (const std::uint32_t together : {1u, 2u, 3u}) {
        PoissonSolver solver(test_device(), problem.width, problem.height, 3, Precision::single, together);
        solutions.push_back(solve(solver, problem.images_with_variances(), options));
    }
    for (const Solution &other : {solutions[1], solutions[2]}) {
        EXPECT_EQ(other.image, solutions[0].image);
        EXPECT_EQ(other.report.iterations, solutions[0].report.iterations);
        EXPECT_EQ(other.report.converged, solutions[0].report.converged);
        EXPECT_EQ(other.report.residuals, solutions[0].report.residuals);
        EXPECT_EQ(other.report.objectives, solutions[0].report.objectives);
        EXPECT_EQ(other.report.correction, solutions[0].report.correction);
    }
}

TEST_P(Groups, DoNotChangeABit) { expect_equal_bits(unequal_channels(129, 65), GetParam()); }

/// Of several tiles across.
TEST(LargeGroups, DoNotChangeABit) {
    const PoissonProblem problem = unequal_channels(1000, 611);
    PoissonOptions l1;
    l1.iterations = 3;
    expect_equal_bits(problem, l1);
    expect_equal_bits(problem, l2_options(LinearMethod::multigrid));
}

std::vector<PoissonOptions> all_options() {
    std::vector<PoissonOptions> all = {{}, plain_l1_options()};
    all.emplace_back().joint_channels = false;
    for (const LinearMethod method : linear_methods)
        all.push_back(l2_options(method, 0.5));
    PoissonOptions &weighted = all.emplace_back(l2_options(LinearMethod::automatic));
    weighted.weigh_by_variance = weighted.alpha_from_variances = true;
    PoissonOptions by_noise = weighted;
    by_noise.noise_share = 1e-3;
    all.push_back(by_noise);
    return all;
}

INSTANTIATE_TEST_SUITE_P(Solver, Groups, ::testing::ValuesIn(all_options()));

/// They have tiles of fewer lines, and all channels at once.
TEST(ManyCores, DoNotChangeABit) {
    const PoissonProblem problem = unequal_channels(1000, 611);
    PoissonOptions l1;
    l1.iterations = 3;
    PoissonOptions weighted = l2_options(LinearMethod::automatic);
    weighted.weigh_by_variance = weighted.alpha_from_variances = true;
    Device few, many;
    few.implementation().description.compute_units = 2;
    many.implementation().description.compute_units = 64;
    for (const PoissonOptions &options : {l1, weighted, l2_options(LinearMethod::multigrid)}) {
        const auto image = [&](Device &device) {
            PoissonSolver solver(device, problem.width, problem.height, 3);
            return solve(solver, problem.images_with_variances(), options).image;
        };
        EXPECT_EQ(image(few), image(many));
    }
}

TEST(ChannelsTogether, AreMoreWhereThereAreMoreCores) {
    DeviceDescription device;
    device.is_host = true;
    device.memory_bytes = std::uint64_t(1) << 40;
    const auto together = [&](unsigned cores, std::uint32_t width, std::uint32_t height) {
        device.compute_units = cores;
        return solver::channels_together(device, solver::Grid(width, height), 3, Precision::single);
    };
    EXPECT_EQ(together(2, 256, 256), 3u);
    EXPECT_EQ(together(2, 512, 512), 1u);
    EXPECT_EQ(together(1, 256, 256), 3u);
    EXPECT_EQ(together(16, 1280, 720), 3u);
    EXPECT_EQ(together(16, 3840, 2160), 1u);
    // What takes half of the memory is never done together.
    device.memory_bytes = std::uint64_t(256) << 20;
    EXPECT_EQ(together(16, 1280, 720), 1u);
}

/// The buffers of a solve in planes of one channel, for a 512 x 512 image.
double planes_of(const PoissonOptions &options, std::uint32_t together) {
    constexpr std::uint32_t side = 512;
    const PoissonProblem problem = make_poisson_problem(side, side, 3, 1);
    Device device;
    PoissonSolver solver(device, side, side, 3, Precision::single, together);
    const PoissonReport report = solve(solver, problem.images_with_variances(), options).report;
    return double(report.device_bytes) / (4.0 * solver::Grid(side, side).plane);
}

TEST(Memory, OfOneChannelAfterTheOther) {
    PoissonOptions automatic;
    automatic.alpha_from_variances = true;
    // I0, both gradients, u and one to spare for each channel, three that say what is valid, four of weights on all
    // grids (4/3), three of multigrid on all grids, b, two directions and their image, two of partial sums; and less
    // than two more for small things.
    EXPECT_LE(planes_of(automatic, 1), 15 + 3 + 4 * 4 / 3. + 3 * 4 / 3. + 4 + 2 + 2);
    EXPECT_GE(planes_of(automatic, 3), 15 + 3 + 4 * 4 / 3. + 3 * 3 * 4 / 3. + 3 * 4 + 2);
    // Without weights that lie in memory, without directions; sums of three channels.
    EXPECT_LE(planes_of(l2_options(LinearMethod::automatic), 1), 15 + 3 + 4 / 3. + 3 * 4 / 3. + 1 + 3 + 2);
}

/// docs/solver.md, "Memory". A page in whole planes is right to half of one; small things are less where images are
/// larger than this one.
TEST(Memory, IsWhatThePageSays) {
    PoissonOptions l1;
    l1.alpha_from_variances = true;
    PoissonOptions weighted = l2_options(LinearMethod::automatic);
    weighted.weigh_by_variance = weighted.alpha_from_variances = true;
    const PoissonOptions uniform = l2_options(LinearMethod::automatic);
    const auto expect = [](const PoissonOptions &options, double one_by_one, double together) {
        EXPECT_NEAR(planes_of(options, 1), one_by_one, 0.75);
        EXPECT_NEAR(planes_of(options, 3), together, 0.75);
    };
    expect(l1, 34, 51);
    expect(uniform, 29, 40);
    expect(weighted, 49, 65);
    l1.joint_channels = weighted.joint_channels = false;
    expect(l1, 58, 74);
    expect(weighted, 66, 82);
}

TEST(Sources, AreReadOnceAndGiveTheSameBits) {
    const PoissonProblem problem = make_poisson_problem(129, 65, 3, 1);
    const std::vector<float> direct(problem.primal.size(), 0.5f);
    HostImages images = problem.images_with_variances();
    images.direct = direct.data();
    PoissonOptions options;
    options.alpha_from_variances = true;
    PoissonSolver &solver = solver_for(problem);
    const Solution expected = solve(solver, images, options);

    std::vector<std::string> calls;
    const auto source = [&](const char *name, const float *image) -> PlaneSource {
        return [&calls, &problem, name, image](std::uint32_t channel, float *plane) {
            calls.push_back(name + std::to_string(channel));
            std::copy_n(image + channel * problem.pixels(), problem.pixels(), plane);
        };
    };
    ImageSources sources;
    sources.primal = source("primal", images.primal);
    sources.dx = source("dx", images.dx);
    sources.dy = source("dy", images.dy);
    sources.direct = source("direct", images.direct);
    sources.primal_variance = source("primal variance", images.primal_variance);
    sources.dx_variance = source("dx variance", images.dx_variance);
    sources.dy_variance = source("dy variance", images.dy_variance);
    std::vector<float> result(problem.primal.size());
    solver.solve(
        sources, options,
        [&](std::uint32_t channel, const float *plane) {
            calls.push_back("result" + std::to_string(channel));
            std::copy_n(plane, problem.pixels(), result.begin() + std::ptrdiff_t(channel * problem.pixels()));
        },
        [&] { calls.push_back("all read"); });
    EXPECT_EQ(result, expected.image);
    std::vector<std::string> in_order;
    for (const char *name :
         {"primal", "dx", "dy", "dx variance", "dy variance", "primal variance", "", "direct", "result"})
        for (const char *channel : {"0", "1", "2"})
            if (*name)
                in_order.push_back(std::string(name) + channel);
            else if (*channel == '0')
                in_order.emplace_back("all read");
    EXPECT_EQ(calls, in_order);
}

// A caller's source may throw, and memory may be short, wherever a solve is: the next one is as if nothing had been.
TEST(Sources, ThatFailLeaveNothingToTheNextSolve) {
    const PoissonProblem problem = make_poisson_problem(65, 33, 3, 1);
    const HostImages images = problem.images_with_variances();
    DeviceDescription &device = test_device().implementation().description;
    const DeviceDescription before = device;
    PoissonOptions first, second;
    first.alpha_from_variances = second.alpha_from_variances = second.weigh_by_variance = true;
    first.norm = PoissonNorm::l1;
    second.norm = PoissonNorm::l2;
    const auto newly = [&](const PoissonOptions &options) {
        PoissonSolver solver(test_device(), 65, 33);
        return solve(solver, images, options).image;
    };
    const std::array<std::vector<float>, 2> expected = {newly(first), newly(second)};
    for (int failing = 0; failing < 7; ++failing)
        for (const bool memory : {false, true}) {
            SCOPED_TRACE(std::to_string(failing) + (memory ? ", memory" : ", source"));
            int calls = 0;
            const auto source = [&](const float *image) -> PlaneSource {
                return [&, image](std::uint32_t channel, float *plane) {
                    if (channel == 0 && calls++ == failing) {
                        if (!memory)
                            throw Error(ExitCode::image, "the file ends");
                        device.allocation_bytes = 100; // for the coarsest grids alone
                    }
                    std::copy_n(image + channel * problem.pixels(), problem.pixels(), plane);
                };
            };
            ImageSources sources;
            sources.primal = source(images.primal);
            sources.dx = source(images.dx);
            sources.dy = source(images.dy);
            sources.direct = source(images.primal);
            sources.primal_variance = source(images.primal_variance);
            sources.dx_variance = source(images.dx_variance);
            sources.dy_variance = source(images.dy_variance);
            PoissonSolver solver(test_device(), 65, 33);
            const auto fails = [&] { solver.solve(sources, first, [](std::uint32_t, const float *) {}); };
            if (memory && failing == 6)
                EXPECT_NO_THROW(fails()); // all is allocated by then
            else
                EXPECT_THROW(fails(), Error);
            device = before;
            EXPECT_EQ(solver.width(), 65u);
            EXPECT_EQ(solve(solver, images, second).image, expected[1]);
            EXPECT_EQ(solve(solver, images, first).image, expected[0]);
        }
}

} // namespace
} // namespace gradus::testing
