#include "solver/poisson_solver.h"

#include "runtime/error.h"
#include "solver/mean_correction.h"
#include "solver/problem.h"
#include "solver/reweighting.h"
#include "solver/workspace.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <memory>

namespace gradus {

using namespace solver;

namespace {

constexpr double default_tolerance = 1e-5;
constexpr std::uint32_t most_channels = 8;

/// Enough to reach the default tolerance at alpha 0.02 where the method can.
int default_iterations(LinearMethod method) {
    switch (method) {
    case LinearMethod::jacobi:
        return 4000;
    case LinearMethod::cg:
        return 1000;
    default:
        return 100;
    }
}

template <class Planes>
void check(const PoissonImages<Planes> &images, const PoissonOptions &options) {
    const auto usage = [](const std::string &message) { throw Error(ExitCode::usage, message); };
    if (!images.primal || !images.dx || !images.dy)
        usage("a reconstruction needs the primal image, dx and dy");
    if (!options.alpha_from_variances && !(options.alpha >= 0 && std::isfinite(options.alpha)))
        usage(fmt::format("alpha is {}; it must be a number, 0 or larger", options.alpha));
    if (!(options.damping > 0 && options.damping <= 1))
        usage(fmt::format("damping is {}; it must be above 0 and at most 1", options.damping));
    if (!(options.tolerance >= 0))
        usage(fmt::format("tolerance is {}; it must be 0 or larger", options.tolerance));
    if (options.iterations < 0 || options.inner_iterations < 1)
        usage("counts of iterations must be above 0 (or 0 for the default)");
    const bool variances = images.primal_variance && images.dx_variance && images.dy_variance;
    if ((options.alpha_from_variances || options.weigh_by_variance) && !variances)
        usage("alpha or weights from variances need the variances of primal, dx and dy");
    if (options.weigh_by_variance && options.norm == PoissonNorm::l1)
        usage("weights by variance are for the L2 norm; the L1 norm has weights of its own");
}

} // namespace

const char *method_name(LinearMethod method) {
    switch (method) {
    case LinearMethod::automatic:
        return "auto";
    case LinearMethod::jacobi:
        return "jacobi";
    case LinearMethod::cg:
        return "cg";
    case LinearMethod::pcg:
        return "pcg";
    case LinearMethod::multigrid:
        return "multigrid";
    }
    return "";
}

struct PoissonSolver::Implementation {
    Implementation(Device &device, std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                   Precision precision)
        : device(device), width(width), height(height), channels(channels),
          workspace(device, width, height, channels, precision), problem(workspace), reweighting(workspace) {}

    PoissonReport solve(const DeviceImages &images, const PoissonOptions &options, Buffer &result);
    void least_squares(const DeviceImages &images, const PoissonOptions &options, double alpha, Buffer &result,
                       PoissonReport &report);
    void absolute_values(const DeviceImages &images, const PoissonOptions &options, double alpha, Buffer &result,
                         PoissonReport &report);
    /// A buffer of the caller's floats, kept from solve to solve.
    const Buffer *upload(const char *name, const float *values);

    std::size_t bytes() const { return std::size_t(width) * height * channels * sizeof(float); }

    Device &device;
    const std::uint32_t width, height, channels;
    Workspace workspace;
    Problem problem;
    Reweighting reweighting;
    std::unique_ptr<MeanCorrection> mean_correction;
    std::map<std::string, Buffer> uploads;
    Buffer result;
};

void PoissonSolver::Implementation::least_squares(const DeviceImages &images, const PoissonOptions &options,
                                                  double alpha, Buffer &result, PoissonReport &report) {
    const bool uniform = !problem.anything_missing() && !options.weigh_by_variance;
    Kernels &kernels = workspace.kernels(uniform                  ? Weights::uniform
                                         : options.joint_channels ? Weights::joint
                                                                  : Weights::per_channel);
    if (!uniform)
        problem.make_base_weights(kernels, options.weigh_by_variance);
    problem.use_least_squares_weights(kernels, alpha);
    problem.make_right_side(kernels);

    LinearSolver::Request request;
    request.method = options.method != LinearMethod::automatic ? options.method
                     : uniform                                 ? LinearMethod::multigrid
                                                               : LinearMethod::pcg;
    request.tolerance = options.tolerance > 0 ? options.tolerance : default_tolerance;
    request.iterations = options.iterations > 0 ? options.iterations : default_iterations(request.method);
    request.damping = options.damping;
    const double norm = images.start ? problem.norm_of_right_side() : 0;
    problem.start(images);
    if (uniform && images.start)
        problem.remove_mean(kernels);
    const LinearReport linear = workspace.linear.solve(kernels, request, problem.right_side(), problem.u(), norm);
    report.method = method_name(request.method);
    report.iterations = linear.iterations;
    report.converged = linear.converged;
    report.residuals = linear.residuals;
    report.objective = problem.squared_norm(kernels);
    report.filled = problem.compose(kernels, images, uniform, result);
}

void PoissonSolver::Implementation::absolute_values(const DeviceImages &images, const PoissonOptions &options,
                                                    double alpha, Buffer &result, PoissonReport &report) {
    Kernels &kernels = workspace.kernels(options.joint_channels ? Weights::joint : Weights::per_channel);
    problem.make_base_weights(kernels, false);
    reweighting.run(kernels, problem, alpha, images, options, report);
    report.method = fmt::format(
        "irls, {}", method_name(options.method == LinearMethod::automatic ? LinearMethod::pcg : options.method));
    if (options.keep_mean) {
        if (!mean_correction)
            mean_correction = std::make_unique<MeanCorrection>(workspace);
        // Which pixels an equation holds is told by the weights that the correction replaces.
        problem.find_held(kernels);
        report.correction = mean_correction->add(kernels, problem);
    }
    // Without a data term, no equation but this one tells the mean.
    report.filled = problem.compose(kernels, images, alpha == 0 && !problem.anything_missing(), result);
}

PoissonReport PoissonSolver::Implementation::solve(const DeviceImages &images, const PoissonOptions &options,
                                                   Buffer &result) {
    const auto begin = std::chrono::steady_clock::now();
    check(images, options);
    for (auto &[weights, kernels] : workspace.all_kernels())
        for (Kernel *kernel : kernels->all())
            kernel->reset_usage();
    PoissonReport report;
    problem.import(images, report);
    if (options.alpha_from_variances || options.weigh_by_variance)
        problem.import_variances(images);
    report.alpha = options.alpha_from_variances ? problem.alpha_from_variances() : options.alpha;
    if (options.norm == PoissonNorm::l2)
        least_squares(images, options, report.alpha, result, report);
    else
        absolute_values(images, options, report.alpha, result, report);
    finish(device);
    report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    std::map<std::string, KernelTime> times;
    for (auto &[weights, kernels] : workspace.all_kernels())
        for (Kernel *kernel : kernels->all()) {
            const Kernel::Usage usage = kernel->usage();
            KernelTime &time = times[kernel->name()];
            time.name = kernel->name();
            time.seconds += usage.seconds;
            time.launches += usage.launches;
        }
    for (const auto &[name, time] : times)
        if (time.launches > 0)
            report.kernels.push_back(time);
    return report;
}

const Buffer *PoissonSolver::Implementation::upload(const char *name, const float *values) {
    if (!values)
        return nullptr;
    Buffer &buffer = uploads[name];
    if (!buffer.valid())
        buffer = Buffer(device, name, bytes());
    std::memcpy(buffer.map(Access::write).as<float>(), values, bytes());
    return &buffer;
}

PoissonSolver::PoissonSolver(Device &device, std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                             Precision precision) {
    if (width == 0 || height == 0)
        throw Error(ExitCode::usage, fmt::format("an image of {} x {} pixels has nothing to solve", width, height));
    if (channels == 0 || channels > most_channels)
        throw Error(ExitCode::usage, fmt::format("{} channels; the solver takes 1 to {}", channels, most_channels));
    implementation_ = std::make_unique<Implementation>(device, width, height, channels, precision);
}

PoissonSolver::~PoissonSolver() = default;

std::uint32_t PoissonSolver::width() const { return implementation_->width; }
std::uint32_t PoissonSolver::height() const { return implementation_->height; }
std::uint32_t PoissonSolver::channels() const { return implementation_->channels; }

PoissonReport PoissonSolver::solve(const DeviceImages &images, const PoissonOptions &options, Buffer &result) {
    const std::size_t bytes = implementation_->bytes();
    const std::initializer_list<const Buffer *> buffers = {
        images.primal, images.dx,          images.dy,          images.direct,
        images.start,  images.dx_variance, images.dy_variance, images.primal_variance,
        &result};
    for (const Buffer *buffer : buffers)
        if (buffer && buffer->bytes() < bytes)
            throw Error(ExitCode::usage,
                        fmt::format("{} has {} bytes; an image of {} x {} pixels and {} channels has {}",
                                    buffer->name(), buffer->bytes(), width(), height(), channels(), bytes));
    return implementation_->solve(images, options, result);
}

PoissonReport PoissonSolver::solve(const HostImages &images, const PoissonOptions &options, float *result) {
    check(images, options);
    Implementation &i = *implementation_;
    DeviceImages on_device;
    on_device.primal = i.upload("primal", images.primal);
    on_device.dx = i.upload("dx", images.dx);
    on_device.dy = i.upload("dy", images.dy);
    on_device.direct = i.upload("direct", images.direct);
    on_device.start = i.upload("start", images.start);
    on_device.primal_variance = i.upload("primal_variance", images.primal_variance);
    on_device.dx_variance = i.upload("dx_variance", images.dx_variance);
    on_device.dy_variance = i.upload("dy_variance", images.dy_variance);
    if (!i.result.valid())
        i.result = Buffer(i.device, "result", i.bytes());
    PoissonReport report = i.solve(on_device, options, i.result);
    i.result.read(result, i.bytes());
    return report;
}

} // namespace gradus
