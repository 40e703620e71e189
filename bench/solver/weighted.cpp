#include "bench/solver/measurements.h"
#include "bench/solver/rival.h"
#include "solver/weighted_reconstruction.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace gradus::bench {

namespace {

constexpr std::uint64_t samples_of_half = 8;

HalfImages uploaded(Device &device, const testing::PoissonProblem &half) {
    const auto buffer = [&](const char *name, const std::vector<float> &values) {
        return Buffer(device, name, values.data(), values.size() * sizeof(float));
    };
    return {buffer("primal", half.primal),
            buffer("dx", half.dx),
            buffer("dy", half.dy),
            buffer("primal_variance", half.primal_variance),
            buffer("dx_variance", half.dx_variance),
            buffer("dy_variance", half.dy_variance),
            samples_of_half * half.pixels()};
}

/// sqrt(mean (a - b)^2) over all values.
double distance(const std::vector<float> &a, const std::vector<float> &b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += (double(a[i]) - b[i]) * (double(a[i]) - b[i]);
    return std::sqrt(sum / double(a.size()));
}

} // namespace

nlohmann::json measure_weighted(const Settings &settings, std::uint32_t width, std::uint32_t height) {
    Device &device = settings.device;
    const std::array<testing::PoissonProblem, 2> halves = {testing::make_jumping_problem(width, height, channels, 1),
                                                           testing::make_jumping_problem(width, height, channels, 2)};
    const HalvedImages images = {uploaded(device, halves[0]), uploaded(device, halves[1])};
    std::vector<float> image(halves[0].primal.size());
    Buffer result(device, "result", image.size() * sizeof(float));
    PoissonSolver solver(device, width, height, channels);
    WeightedReconstruction weighted(device, solver);
    Rival rival(width, height, channels, settings.threads);
    const DeviceImages of_l1 = {&images[0].primal, &images[0].dx, &images[0].dy};

    // Warms up, and looks at what the answers are worth.
    const int steps = weighted.solve(images, result).iterations;
    result.read(image.data(), result.bytes());
    const double error = distance(image, halves[0].clean);
    solver.solve(of_l1, {}, result);
    std::vector<double> seconds, rival_seconds, l1_seconds, over_rival, over_l1;
    const auto timed = [&](std::vector<double> &times, auto solve) {
        finish(device);
        times.push_back(seconds_of([&] {
            solve();
            finish(device);
        }));
    };
    for (int turn = 0; turn < settings.repeats; ++turn) {
        timed(seconds, [&] { weighted.solve(images, result); });
        timed(rival_seconds, [&] { rival.solve(halves[0].images(), chart_alpha); });
        timed(l1_seconds, [&] { solver.solve(of_l1, {}, result); });
        over_rival.push_back(seconds.back() / 2 / rival_seconds.back());
        over_l1.push_back(seconds.back() / l1_seconds.back());
    }
    fmt::print("Weighted, both halves, {}x{} RGB, variances that jump by up to 30000\n", width, height);
    fmt::print("  {} steps, {:.3f} s; error {:.3g}, of a half's primal {:.3g}\n", steps, median(seconds), error,
               distance(halves[0].primal, halves[0].clean));
    fmt::print("  a half over FFTW's uniform solve, {:.3f} s: {:.2f} (target 3)\n", median(rival_seconds),
               median(over_rival));
    fmt::print("  both over L1, {:.3f} s: {:.2f}\n\n", median(l1_seconds), median(over_l1));
    return {{"size", fmt::format("{}x{}", width, height)},
            {"iterations", steps},
            {"error", error},
            {"seconds", spread(seconds)},
            {"fftw_seconds", spread(rival_seconds)},
            {"l1_seconds", spread(l1_seconds)},
            {"half_over_fftw", spread(over_rival)},
            {"over_l1", spread(over_l1)}};
}

} // namespace gradus::bench
