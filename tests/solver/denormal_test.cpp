// Denormal numbers cost nothing: where they are not flushed to zero a solve takes several times as long.
#include "tests/solver/solver_fixture.h"

#include <algorithm>
#include <chrono>

namespace gradus::testing {
namespace {

constexpr double allowed_ratio = 2;

/// Wall seconds of a fixed number of steps.
double seconds(PoissonSolver &solver, const HostImages &images, const PoissonOptions &options) {
    std::vector<float> result(std::size_t(solver.width()) * solver.height() * solver.channels());
    const auto start = std::chrono::steady_clock::now();
    solver.solve(images, options, result.data());
    EXPECT_EQ(count_non_finite(result), 0u);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

class Denormals : public ::testing::TestWithParam<PoissonOptions> {
  protected:
    /// The median of five ratios, each of two solves one after the other.
    void check(const PoissonProblem &normal, const PoissonProblem &denormal) {
        PoissonSolver &solver = solver_for(normal);
        seconds(solver, normal.images(), GetParam()); // compiles
        std::vector<double> ratios;
        for (int k = 0; k < 5; ++k) {
            const double usual = seconds(solver, normal.images(), GetParam());
            ratios.push_back(seconds(solver, denormal.images(), GetParam()) / usual);
        }
        std::sort(ratios.begin(), ratios.end());
        std::printf("time for denormal inputs relative to normal ones: %.2f (%.2f to %.2f)\n", ratios[2], ratios[0],
                    ratios[4]);
        EXPECT_LE(ratios[2], allowed_ratio);
    }

    /// So much work that compiling and copying do not hide the arithmetic.
    const PoissonProblem normal = make_poisson_problem(512, 512, 3, 1);
};

TEST_P(Denormals, InTheInputsCostNothing) {
    PoissonProblem scaled = normal;
    for (std::vector<float> *plane : {&scaled.primal, &scaled.dx, &scaled.dy})
        for (float &value : *plane)
            value = float(value * 1e-38);
    check(normal, scaled);
    // One pixel of normal size keeps the iteration going over all others.
    scaled.primal[scaled.at(1, 100, 50)] = 1;
    check(normal, scaled);
}

/// Black but for some pixels: what an iteration spreads from there falls off through all denormal numbers.
TEST_P(Denormals, InTheTailOfASolutionCostNothing) {
    PoissonProblem black = normal;
    for (std::vector<float> *plane : {&black.primal, &black.dx, &black.dy})
        std::fill(plane->begin(), plane->end(), 0.0f);
    black.primal[black.at(1, 256, 256)] = 1;
    for (std::uint32_t x = 0; x < 512; ++x) // and a line, whose whole tail is so small
        black.primal[black.at(0, x, 128)] = 1e-36f;
    check(normal, black);
}

/// Not all processors are slow at denormal numbers, so that they are flushed is tested by itself.
TEST(DenormalNumbers, AreFlushed) {
    if (!test_device().description().is_host)
        GTEST_SKIP() << "other devices may compute with denormal numbers at full speed";
    PoissonProblem problem = make_exact_problem(75, 43, 3);
    problem.primal.assign(problem.primal.size(), 1e-39f);
    problem.dx.assign(problem.dx.size(), 0);
    problem.dy.assign(problem.dy.size(), 0);
    for (const PoissonNorm norm : {PoissonNorm::l1, PoissonNorm::l2}) {
        PoissonOptions options;
        options.norm = norm;
        const std::vector<float> image = solve(problem, options).image;
        EXPECT_EQ(std::count(image.begin(), image.end(), 0.0f), std::ptrdiff_t(image.size()));
    }
}

PoissonOptions fixed_steps(LinearMethod method, int iterations) {
    // A large alpha makes the tail short, so that it passes through the denormal numbers within the image.
    PoissonOptions options = l2_options(method, 1, 1e-30);
    options.iterations = iterations;
    return options;
}

PoissonOptions fixed_reweightings() {
    PoissonOptions options;
    options.iterations = 6;
    options.tolerance = 1e-30;
    return options;
}

std::string name_of_steps(const ::testing::TestParamInfo<PoissonOptions> &info) {
    return info.param.norm == PoissonNorm::l1 ? "L1" : method_name(info.param.method);
}

// These two launch all kernels of the others but those of jacobi.
INSTANTIATE_TEST_SUITE_P(Solver, Denormals, ::testing::Values(fixed_steps(LinearMethod::pcg, 8), fixed_reweightings()),
                         name_of_steps);
INSTANTIATE_TEST_SUITE_P(Full, Denormals,
                         ::testing::Values(fixed_steps(LinearMethod::jacobi, 60), fixed_steps(LinearMethod::cg, 40),
                                           fixed_steps(LinearMethod::multigrid, 8)),
                         name_of_steps);

} // namespace
} // namespace gradus::testing
