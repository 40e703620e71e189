// Equal inputs give equal bits: again, after other problems, and from device memory.
#include "tests/solver/solver_fixture.h"

#include <ostream>

namespace gradus::testing {
namespace {

struct Case {
    std::string name;
    PoissonOptions options;
};

void PrintTo(const Case &c, std::ostream *out) { *out << c.name; }

std::vector<Case> cases() {
    PoissonOptions weighted = l2_options(LinearMethod::automatic), by_channel, of_differences;
    weighted.weigh_by_variance = true;
    by_channel.joint_channels = false;
    of_differences.alpha = 0;
    return {{"L2_jacobi", l2_options(LinearMethod::jacobi)},
            {"L2_cg", l2_options(LinearMethod::cg)},
            {"L2_pcg", l2_options(LinearMethod::pcg)},
            {"L2_multigrid", l2_options(LinearMethod::multigrid)},
            {"L2_weighted", weighted},
            {"L1", PoissonOptions()},
            {"L1_plain", plain_l1_options()},
            {"L1_by_channel", by_channel},
            {"L1_of_differences", of_differences}};
}

class Repeat : public ::testing::TestWithParam<Case> {
  protected:
    const PoissonProblem problem = make_poisson_problem(129, 65, 3, 1);
    const PoissonOptions options = GetParam().options;
};

TEST_P(Repeat, GivesTheSameBits) {
    PoissonSolver &solver = solver_for(problem);
    const Solution first = solve(solver, problem.images_with_variances(), options);
    EXPECT_EQ(count_non_finite(first.image), 0u);
    // Another problem, with missing inputs, by another norm, leaves nothing behind.
    PoissonProblem other = make_poisson_problem(129, 65, 3, 2);
    other.primal[77] = other.dx[1000] = std::numeric_limits<float>::quiet_NaN();
    PoissonOptions other_options;
    other_options.norm = options.norm == PoissonNorm::l1 ? PoissonNorm::l2 : PoissonNorm::l1;
    other_options.alpha = 1;
    solve(solver, other.images(), other_options);
    const Solution again = solve(solver, problem.images_with_variances(), options);
    EXPECT_EQ(first.image, again.image);
    EXPECT_EQ(first.report.residuals, again.report.residuals);
    EXPECT_EQ(first.report.objectives, again.report.objectives);
    PoissonSolver fresh(test_device(), problem.width, problem.height, problem.channels);
    EXPECT_EQ(first.image, solve(fresh, problem.images_with_variances(), options).image);
}

/// What is no number stays in no memory that a later solve reads.
TEST_P(Repeat, AfterWhatOverflows) {
    PoissonSolver solver(test_device(), problem.width, problem.height, problem.channels);
    PoissonProblem huge = problem;
    for (std::vector<float> *plane : {&huge.primal, &huge.dx, &huge.dy})
        for (float &value : *plane)
            value = value < 0 ? -3e38f : 3e38f;
    const std::vector<float> expected = solve(solver_for(problem), problem.images_with_variances(), options).image;
    for (const Case &c : cases())
        solve(solver, huge.images_with_variances(), c.options);
    EXPECT_EQ(solve(solver, problem.images_with_variances(), options).image, expected);
    for (const LinearMethod method : linear_methods)
        solve(solver, problem.images(), l2_options(method, 1e30));
    EXPECT_EQ(solve(solver, problem.images_with_variances(), options).image, expected);
}

TEST_P(Repeat, FromDeviceMemoryToo) {
    PoissonSolver &solver = solver_for(problem);
    std::vector<float> direct(problem.primal.size(), 0.5f);
    HostImages host = problem.images_with_variances();
    host.direct = direct.data();
    host.start = problem.clean.data();
    const Solution expected = solve(solver, host, options);

    const std::size_t bytes = problem.primal.size() * sizeof(float);
    const auto upload = [&](const char *name, const float *data) { return Buffer(test_device(), name, data, bytes); };
    Buffer primal = upload("a", host.primal);
    const Buffer dx = upload("b", host.dx), dy = upload("c", host.dy), direct_buffer = upload("d", host.direct),
                 start = upload("e", host.start), primal_variance = upload("f", host.primal_variance),
                 dx_variance = upload("g", host.dx_variance), dy_variance = upload("h", host.dy_variance);
    Buffer result(test_device(), "i", bytes);
    DeviceImages images{&primal, &dx, &dy, &direct_buffer, &start, &primal_variance, &dx_variance, &dy_variance};
    const auto content = [&](const Buffer &buffer) {
        std::vector<float> values(problem.primal.size());
        buffer.read(values.data(), bytes);
        return values;
    };
    const PoissonReport report = solver.solve(images, options, result);
    EXPECT_EQ(content(result), expected.image);
    EXPECT_EQ(report.residuals, expected.report.residuals);
    EXPECT_EQ(content(primal), problem.primal) << "inputs are left as they are";
    EXPECT_EQ(content(dx), problem.dx);
    solver.solve(images, options, primal);
    EXPECT_EQ(content(primal), expected.image) << "the result may be an input";
}

INSTANTIATE_TEST_SUITE_P(Solver, Repeat, ::testing::ValuesIn(cases()),
                         [](const auto &info) { return info.param.name; });

/// Per-channel results do not depend on how many channels are solved at once, but for when the iteration stops.
TEST(RepeatChannels, GiveTheSameImageAlone) {
    const PoissonProblem all = make_poisson_problem(75, 43, 3, 3);
    const Solution together = solve(all, l2_options(LinearMethod::automatic, 0.2, 1e-6));
    PoissonProblem one = all;
    one.channels = 1;
    for (std::uint32_t c = 0; c < 3; ++c) {
        const auto cut = [&](const std::vector<float> &plane) {
            const auto first = plane.begin() + std::ptrdiff_t(c * all.pixels());
            return std::vector<float>(first, first + std::ptrdiff_t(all.pixels()));
        };
        one.primal = cut(all.primal);
        one.dx = cut(all.dx);
        one.dy = cut(all.dy);
        EXPECT_LE(relative_error(solve(one, l2_options(LinearMethod::automatic, 0.2, 1e-6)).image,
                                 to_double(cut(together.image))),
                  1e-4);
    }
}

} // namespace
} // namespace gradus::testing
