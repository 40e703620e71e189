// Input that cannot be solved: an Error with its code, and nothing half-written.
#include "runtime/error.h"
#include "tests/solver/solver_fixture.h"

#include <algorithm>
#include <functional>

namespace gradus::testing {
namespace {

constexpr float untouched = -1e30f;

/// The code and message that solving ends with; checks that the result was not written.
void expect_usage_error(const std::string &name, const std::function<void(HostImages &, PoissonOptions &)> &spoil) {
    const PoissonProblem problem = make_poisson_problem(12, 9, 3, 1);
    PoissonSolver &solver = solver_for(problem);
    HostImages images = problem.images_with_variances();
    PoissonOptions options;
    spoil(images, options);
    std::vector<float> result(problem.primal.size(), untouched);
    try {
        solver.solve(images, options, result.data());
        ADD_FAILURE() << name << " was accepted";
    } catch (const Error &error) {
        EXPECT_EQ(error.code, ExitCode::usage) << name << ": " << error.what();
        EXPECT_STRNE(error.what(), "") << name;
    }
    EXPECT_TRUE(std::all_of(result.begin(), result.end(), [](float value) { return value == untouched; })) << name;
    // The solver is as good as new.
    EXPECT_EQ(count_non_finite(solve(solver, problem.images(), PoissonOptions()).image), 0u) << name;
}

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

TEST(Options, OutOfTheirRangeAreRefused) {
    for (const double alpha : {-0.2, -1e-30, not_a_number, std::numeric_limits<double>::infinity()})
        expect_usage_error("alpha " + std::to_string(alpha), [&](auto &, auto &options) { options.alpha = alpha; });
    for (const double alpha : {1e-30, 1e-6, 0.99e-4})
        expect_usage_error("alpha of L1 " + std::to_string(alpha), [&](auto &, auto &options) {
            options.norm = PoissonNorm::l1;
            options.alpha = alpha;
        });
    for (const double tolerance : {-1e-5, not_a_number})
        expect_usage_error("tolerance " + std::to_string(tolerance),
                           [&](auto &, auto &options) { options.tolerance = tolerance; });
    for (const double share : {-1.0, not_a_number})
        expect_usage_error("share of the noise " + std::to_string(share),
                           [&](auto &, auto &options) { options.noise_share = share; });
    for (const double damping : {0.0, -1.0, 1.5, not_a_number})
        expect_usage_error("damping " + std::to_string(damping), [&](auto &, auto &options) {
            options.norm = PoissonNorm::l2;
            options.method = LinearMethod::jacobi;
            options.damping = damping;
        });
    expect_usage_error("iterations", [](auto &, auto &options) { options.iterations = -1; });
    expect_usage_error("inner iterations", [](auto &, auto &options) { options.inner_iterations = -1; });
    expect_usage_error("no inner iterations", [](auto &, auto &options) { options.inner_iterations = 0; });
}

TEST(Options, OneVarianceIsForBuffers) {
    expect_usage_error("one variance", [](auto &images, auto &) { images.one_variance = true; });
}

TEST(Options, AResultThatGoesNowhereIsAnError) {
    const PlaneSource zeros = [](std::uint32_t, float *plane) { std::fill_n(plane, 12 * 9, 0.0f); };
    ImageSources images;
    images.primal = images.dx = images.dy = zeros;
    EXPECT_THROW(PoissonSolver(test_device(), 12, 9, 3).solve(images, PoissonOptions(), PlaneSink()), Error);
}

TEST(Options, ImagesThatAreMissingAreNamed) {
    expect_usage_error("no primal", [](auto &images, auto &) { images.primal = nullptr; });
    expect_usage_error("no dx", [](auto &images, auto &) { images.dx = nullptr; });
    expect_usage_error("no dy", [](auto &images, auto &) { images.dy = nullptr; });
}

TEST(Options, VariancesThatAreNeededAreAskedFor) {
    const auto drop = [](HostImages &images) {
        images.primal_variance = images.dx_variance = images.dy_variance = nullptr;
    };
    expect_usage_error("alpha from no variances", [&](auto &images, auto &options) {
        drop(images);
        options.alpha_from_variances = true;
    });
    expect_usage_error("weights from no variances", [&](auto &images, auto &options) {
        drop(images);
        options.norm = PoissonNorm::l2;
        options.weigh_by_variance = true;
    });
    expect_usage_error("two variances of three", [&](auto &images, auto &options) {
        images.dx_variance = nullptr;
        options.norm = PoissonNorm::l2;
        options.weigh_by_variance = true;
    });
}

void expect_error(ExitCode code, std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
    try {
        PoissonSolver solver(test_device(), width, height, channels);
        ADD_FAILURE() << width << " x " << height << " x " << channels << " was accepted";
    } catch (const Error &error) {
        EXPECT_EQ(error.code, code) << width << " x " << height << " x " << channels << ": " << error.what();
    }
}

TEST(Options, EmptyImagesAreRefused) {
    expect_error(ExitCode::usage, 0, 5, 3);
    expect_error(ExitCode::usage, 5, 0, 3);
    expect_error(ExitCode::usage, 5, 5, 0);
    expect_error(ExitCode::usage, 5, 5, 9);
}

TEST(Options, ImagesTooLargeForTheDeviceAreRefused) {
    expect_error(ExitCode::device, 200'000, 200'000, 3);
    expect_error(ExitCode::device, 4'000'000'000, 4'000'000'000, 8);
    expect_error(ExitCode::device, 4'294'967'295, 1, 8);
    expect_error(ExitCode::device, 65'536, 65'536, 1); // 2^32 pixels
}

TEST(Options, EveryMethodHasAName) {
    std::vector<std::string> names;
    for (const LinearMethod method : linear_methods) {
        names.push_back(method_name(method));
        EXPECT_FALSE(names.back().empty());
    }
    std::sort(names.begin(), names.end());
    EXPECT_EQ(std::unique(names.begin(), names.end()), names.end());
}

} // namespace
} // namespace gradus::testing
