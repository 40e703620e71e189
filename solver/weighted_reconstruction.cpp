#include "solver/weighted_reconstruction.h"

#include "runtime/seconds_since.h"

#include <algorithm>
#include <chrono>
#include <initializer_list>
#include <utility>

namespace gradus {

namespace {

/// Variances have a bound by place; this one is for where nothing is seen at all. Multigrid cycles diverge where
/// weights jump by a factor of 10^9 from pixel to pixel.
constexpr double largest_weight = 1000;

/// Steps that are left out change the image by at most a fortieth of the squared error that the noise leaves (2.4 % on
/// the Cornell box and on the textures, at most 0.3 % on most scenes): further steps would take more time than samples
/// that gain as much.
constexpr double noise_share = 1e-3;

/// Of the residual, where there is no noise.
constexpr double tolerance = 1e-4;

/// A variance is at least this share of the squared brightness, over the number of samples: none at all is luck.
constexpr double least_of_a_sample = 1e-3;

// Standard deviations of 0.4, 0.8, 1.6, 3.3 and 6.6 pixels in all.
constexpr VarianceSmoother::Smoothing smoothings[] = {{1, 0.07}, {1, 0.5}, {2, 0.5}, {4, 0.5}, {8, 0.5}};

constexpr auto smoothing_kernels = {"mean_of_channels", "smooth_image", "smooth_and_add", "geometric_mean"};

/// Kernels of one program: to build one of them is to compile all.
std::vector<Kernel> weighted_kernels(Device &device, std::uint32_t channels, std::initializer_list<const char *> names,
                                     const KernelLibrary::Progress &progress = {}) {
    KernelLibrary library(
        device, {{"SOLVER_CHANNELS", static_cast<int>(channels)}, {"SOLVER_WEIGHTED", 0}, {"SOLVER_JOINT", 1}});
    std::vector<KernelRequest> requests;
    for (const char *name : names)
        requests.push_back({name, "kernels/solver/smooth_variance.cl", name, {}});
    return library.build(requests, progress);
}

std::vector<float> values_of(const Buffer &image) {
    std::vector<float> values(image.bytes() / sizeof(float));
    image.read(values.data(), image.bytes());
    return values;
}

} // namespace

VarianceSmoother::VarianceSmoother(Device &device, std::uint32_t width, std::uint32_t height, std::uint32_t channels)
    : device_(device), grid_(width, height) {
    std::vector<Kernel> kernels = weighted_kernels(device, channels, smoothing_kernels);
    mean_ = std::move(kernels[0]);
    smooth_ = std::move(kernels[1]);
    smooth_and_add_ = std::move(kernels[2]);
    finish_ = std::move(kernels[3]);
}

void VarianceSmoother::launch(Kernel &kernel, Extent extent) {
    kernel.set("columns", extent.columns);
    kernel.set("rows", extent.rows);
    grid_.launch(kernel, {});
}

void VarianceSmoother::take_mean(const Buffer &image, bool is_variance, Extent extent) {
    mean_.set("is_variance", is_variance);
    mean_.bind("packed", image);
    mean_.bind("mean", image_);
    launch(mean_, extent);
}

void VarianceSmoother::smooth(Kernel &kernel, Smoothing smoothing, Extent extent) {
    kernel.set("apart", smoothing.apart);
    kernel.set_real("side", smoothing.side);
    kernel.bind("image", image_);
    kernel.bind("smoothed", other_);
    launch(kernel, extent);
    std::swap(image_, other_);
}

void VarianceSmoother::allocate() {
    if (image_.valid())
        return;
    // Nothing is there beyond the image, which kernels do not write to.
    const std::vector<float> nothing(grid_.plane, -1.0f);
    for (Buffer *plane : {&image_, &other_, &brightness_})
        *plane = Buffer(device_, "image", nothing.data(), nothing.size() * sizeof(float));
    logarithms_ = solver::PlaneMaker(device_, Precision::single).planes("logarithms", grid_, 1);
    smoothed_ = Buffer(device_, "smoothed", std::size_t(grid_.width) * grid_.height * sizeof(float));
}

void VarianceSmoother::begin(const HalfImages &judge) {
    allocate();
    const double pixels = double(grid_.width) * grid_.height;
    samples_ = std::max(double(judge.samples) / pixels, double(least_half_samples));
    const Extent whole = {grid_.width, grid_.height};
    take_mean(judge.primal, false, whole);
    for (int i = 0; i < 2; ++i)
        smooth(smooth_, {1, 0.5}, whole);
    std::swap(image_, brightness_);
}

const Buffer &VarianceSmoother::smoothed(const Buffer &variance, Differences differences) {
    const Extent extent = {grid_.width - (differences == Differences::right ? 1 : 0),
                           grid_.height - (differences == Differences::down ? 1 : 0)};
    take_mean(variance, true, extent);
    double shares = 0;
    for (const Smoothing &smoothing : smoothings) {
        // The fewer samples, the less the pixel itself knows.
        const double share = shares == 0 ? 2 * (1 - 1 / samples_) : 1;
        smooth_and_add_.set_real("share", share);
        smooth_and_add_.set_real("before", shares);
        smooth_and_add_.set_real("least", least_of_a_sample / samples_);
        smooth_and_add_.bind("brightness", brightness_);
        smooth_and_add_.bind("logarithms", logarithms_);
        smooth(smooth_and_add_, smoothing, extent);
        shares += share;
    }
    finish_.set_real("share", 1 / shares);
    finish_.bind("smoothed", image_);
    finish_.bind("logarithms", logarithms_);
    finish_.bind("packed", smoothed_);
    grid_.launch(finish_, {});
    return smoothed_;
}

ImageMixer::ImageMixer(Device &device) : mix_(std::move(weighted_kernels(device, 3, {"mix_images"}).front())) {}

void ImageMixer::mix(const Buffer &first, double a, const Buffer &second, double b, Buffer &result) {
    const auto count = static_cast<std::uint32_t>(result.bytes() / sizeof(float));
    mix_.set("count", count);
    mix_.set_real("a", a);
    mix_.set_real("b", b);
    mix_.bind("first", first);
    mix_.bind("second", second);
    mix_.bind("mixed", result);
    mix_.launch(count);
}

WeightedReconstruction::WeightedReconstruction(Device &device, PoissonSolver &solver)
    : device_(device), solver_(solver), smoother_(device, solver.width(), solver.height(), solver.channels()),
      mixer_(device) {}

PoissonOptions WeightedReconstruction::options() {
    PoissonOptions options;
    options.norm = PoissonNorm::l2;
    options.alpha = 1; // where nothing varies
    options.alpha_from_variances = true;
    options.weigh_by_variance = true;
    options.largest_weight = largest_weight;
    options.tolerance = tolerance;
    options.noise_share = noise_share;
    return options;
}

void WeightedReconstruction::compile(Device &device, std::uint32_t channels, const KernelLibrary::Progress &progress) {
    weighted_kernels(device, channels, smoothing_kernels, progress);
    PoissonSolver::compile(device, options(), channels, Precision::single, progress);
}

PoissonReport WeightedReconstruction::solve_half(const HalfImages &half, const HalfImages &judge, Buffer &result) {
    const auto image = [](const Buffer &buffer) { return [&buffer]() -> const Buffer & { return buffer; }; };
    const auto variance = [&](const Buffer &buffer, VarianceSmoother::Differences differences) {
        return [&, differences]() -> const Buffer & { return smoother_.smoothed(buffer, differences); };
    };
    reset_times(smoother_.kernels());
    smoother_.begin(judge);
    BufferSources images;
    images.primal = image(half.primal);
    images.dx = image(half.dx);
    images.dy = image(half.dy);
    images.one_variance = true;
    images.primal_variance = variance(judge.primal_variance, VarianceSmoother::Differences::none);
    images.dx_variance = variance(judge.dx_variance, VarianceSmoother::Differences::right);
    images.dy_variance = variance(judge.dy_variance, VarianceSmoother::Differences::down);
    PoissonReport report = solver_.solve(images, options(), result);
    add_times(report.kernels, smoother_.kernels());
    return report;
}

PoissonReport WeightedReconstruction::solve(const HalvedImages &halves, Buffer &result, SquaredErrors *errors) {
    const double first = double(halves[0].samples), second = double(halves[1].samples);
    std::array<Buffer, 2> solutions = {Buffer(device_, "half_solution", result.bytes()), result};
    const PoissonReport report = solve_both(halves, solutions);
    if (errors)
        *errors = errors_of_halves(values_of(solutions[0]), values_of(result), first / (first + second));
    mixer_.mix(solutions[0], first / (first + second), result, second / (first + second), result);
    return report;
}

PoissonReport WeightedReconstruction::solve_both(const HalvedImages &halves, std::array<Buffer, 2> &results) {
    const PoissonReport of_first = solve_half(halves[0], halves[1], results[0]);
    PoissonReport report = solve_half(halves[1], halves[0], results[1]);
    report.iterations += of_first.iterations;
    report.converged = report.converged && of_first.converged;
    report.objective += of_first.objective;
    report.missing_primal += of_first.missing_primal;
    report.missing_dx += of_first.missing_dx;
    report.missing_dy += of_first.missing_dy;
    report.filled += of_first.filled;
    report.seconds += of_first.seconds;
    for (const KernelTime &time : of_first.kernels)
        add_time(report.kernels, time);
    return report;
}

PoissonReport solve_weighted(Device &device, PoissonSolver &solver, const HostHalves &halves, float *result) {
    const auto start = std::chrono::steady_clock::now();
    const std::size_t bytes = std::size_t(solver.width()) * solver.height() * solver.channels() * sizeof(float);
    Buffer solution(device, "solution", bytes);
    PoissonReport report =
        WeightedReconstruction(device, solver).solve(uploaded_halves(device, halves, bytes), solution);
    solution.read(result, bytes);
    report.seconds = seconds_since(start);
    return report;
}

} // namespace gradus
