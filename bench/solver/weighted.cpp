#include "bench/solver/measurements.h"
#include "bench/solver/rival.h"
#include "solver/weighted_reconstruction.h"
#include "tests/support/poisson_reference.h"

#include <fmt/format.h>

#include <array>

namespace gradus::bench {

namespace {

constexpr std::uint64_t samples_of_half = 8;

} // namespace

nlohmann::json measure_weighted(const Settings &settings, std::uint32_t width, std::uint32_t height) {
    Device &device = settings.device;
    const std::array<testing::PoissonProblem, 2> halves = {testing::make_jumping_problem(width, height, channels, 1),
                                                           testing::make_jumping_problem(width, height, channels, 2)};
    std::vector<float> image(halves[0].primal.size());
    Buffer result(device, "result", image.size() * sizeof(float));
    const std::uint64_t samples = samples_of_half * halves[0].pixels();
    const HalvedImages images = uploaded_halves(
        device, {{halves[0].images_with_variances(), halves[1].images_with_variances()}, {samples, samples}},
        result.bytes());
    PoissonSolver solver(device, width, height, channels);
    WeightedReconstruction weighted(device, solver);
    Rival rival(width, height, channels, settings.threads);
    const DeviceImages of_l1 = {&images[0].primal, &images[0].dx, &images[0].dy};

    // Warms up, and looks at what the answers are worth.
    const int steps = weighted.solve(images, result).iterations;
    result.read(image.data(), result.bytes());
    const std::vector<double> clean = testing::to_double(halves[0].clean);
    const double error = testing::relative_error(image, clean);
    solver.solve(of_l1, {}, result);
    std::vector<double> seconds, rival_seconds, l1_seconds, over_rival, over_l1;
    for (int turn = 0; turn < settings.repeats; ++turn) {
        seconds.push_back(seconds_of(device, [&] { weighted.solve(images, result); }));
        rival_seconds.push_back(seconds_of([&] { rival.solve(halves[0].images(), chart_alpha); }));
        l1_seconds.push_back(seconds_of(device, [&] { solver.solve(of_l1, {}, result); }));
        over_rival.push_back(seconds.back() / 2 / rival_seconds.back());
        over_l1.push_back(seconds.back() / l1_seconds.back());
    }
    fmt::print("Weighted, both halves, {}x{} RGB, variances that jump by up to 30000\n", width, height);
    fmt::print("  {} steps, {:.3f} s; relative error {:.3g}, of a half's primal {:.3g}\n", steps, median(seconds),
               error, testing::relative_error(halves[0].primal, clean));
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
