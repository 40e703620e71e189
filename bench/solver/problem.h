// A problem of one size with a solver for it, its inputs in device memory, and its answer in double precision.
#pragma once

#include "bench/spread.h"
#include "solver/poisson_solver.h"
#include "tests/support/poisson_problem.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gradus::bench {

/// What all measurements share.
struct Settings {
    Device &device;
    int threads = 1; ///< of FFTW and of the triad; the device has as many
    int repeats = 5;
    /// The largest counts of iterations on the charts are those that take so many seconds.
    double longest = 2;
};

constexpr double chart_alpha = 0.2;

constexpr std::uint32_t channels = 3;

/// Inputs on the host: the same ones for each call.
using Inputs = std::shared_ptr<const testing::PoissonProblem>;
Inputs make_inputs(std::uint32_t width, std::uint32_t height);

class Problem {
  public:
    Problem(const Settings &settings, Inputs inputs);
    Problem(const Settings &settings, std::uint32_t width, std::uint32_t height)
        : Problem(settings, make_inputs(width, height)) {}

    struct Run {
        double seconds = 0; ///< by our own clock, until the device is done
        PoissonReport report;
    };
    /// Device buffers in, a device buffer out.
    Run solve(const PoissonOptions &options);
    /// Host arrays in, a host array out.
    Run solve_on_host(const PoissonOptions &options);
    /// What the last solve() gave.
    const std::vector<float> &image();

    /// The L2 solution for chart_alpha, computed when it is first asked for.
    const std::vector<double> &reference();
    /// Relative, in the Euclidean norm over all values.
    double error(const std::vector<float> &image);
    /// ||b - A u|| / ||b|| in double precision, for u = image - primal.
    double residual(const std::vector<float> &image) const;

    std::string name() const; ///< "1280x720"
    std::size_t pixels() const { return inputs_->pixels(); }
    std::uint32_t width() const { return inputs_->width; }
    std::uint32_t height() const { return inputs_->height; }
    HostImages images() const { return inputs_->images(); }

  private:
    Run timed(const std::function<PoissonReport()> &solve);

    Device &device_;
    Inputs inputs_;
    Buffer primal_, dx_, dy_, result_;
    PoissonSolver solver_;
    std::vector<float> image_;
    std::optional<std::vector<double>> reference_;
};

/// L2 options that take exactly so many steps or cycles, unless nothing is left to gain in float.
PoissonOptions l2_steps(LinearMethod method, int steps);

double seconds_of(const std::function<void()> &work);
/// The same of what a device does: from when it has nothing left of before to when it is done.
double seconds_of(Device &device, const std::function<void()> &work);

} // namespace gradus::bench
