#include "solver/poisson_solver.h"

#include "runtime/device/program.h"
#include "runtime/error.h"
#include "runtime/seconds_since.h"
#include "solver/mean_correction.h"
#include "solver/pieces.h"
#include "solver/problem.h"
#include "solver/reweighting.h"
#include "solver/workspace.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>

namespace gradus {

using namespace solver;

namespace {

constexpr double default_tolerance = 1e-5;
constexpr std::uint32_t most_channels = 8;

/// The weights of a problem in which something may be missing.
Weights weights_for(const PoissonOptions &options, bool missing) {
    const bool uniform = options.norm == PoissonNorm::l2 && !missing && !options.weigh_by_variance;
    return uniform ? Weights::uniform : options.joint_channels ? Weights::joint : Weights::per_channel;
}

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
    if (options.norm == PoissonNorm::l1 && !options.alpha_from_variances && options.alpha > 0 &&
        options.alpha < least_alpha_of_absolute_values)
        usage(fmt::format("alpha is {}; with the L1 norm it must be 0 or at least {:g}", options.alpha,
                          least_alpha_of_absolute_values));
    if (!(options.damping > 0 && options.damping <= 1))
        usage(fmt::format("damping is {}; it must be above 0 and at most 1", options.damping));
    if (!(options.tolerance >= 0))
        usage(fmt::format("tolerance is {}; it must be 0 or larger", options.tolerance));
    if (!(options.noise_share >= 0))
        usage(fmt::format("the share of the noise is {}; it must be 0 or larger", options.noise_share));
    if (options.iterations < 0 || options.inner_iterations < 1)
        usage("counts of iterations must be above 0 (or 0 for the default)");
    const bool variances = images.primal_variance && images.dx_variance && images.dy_variance;
    if ((options.alpha_from_variances || options.weigh_by_variance) && !variances)
        usage("alpha or weights from variances need the variances of primal, dx and dy");
    if (!(options.largest_weight >= 1 && options.largest_weight <= 1e9))
        usage(fmt::format("the largest weight is {}; it must be 1 to 1e9", options.largest_weight));
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
                   Precision precision, std::uint32_t together)
        : device(device), workspace(device, width, height, channels, precision, together), problem(workspace),
          reweighting(workspace) {}

    using Call = std::function<void()>;
    /// Where the result goes is asked at the end: it may be memory that the solve needs until then.
    PoissonReport solve(const Inputs &images, const PoissonOptions &options, const std::function<Buffer &()> &result,
                        const Call &all_read);
    /// With the report's alpha.
    void least_squares(const Inputs &images, const PoissonOptions &options, PoissonReport &report);
    void absolute_values(const Inputs &images, const PoissonOptions &options, PoissonReport &report);
    /// Those for the weights that the problem and the options ask for.
    Kernels &kernels_for(const PoissonOptions &options) {
        return workspace.kernels(weights_for(options, problem.anything_missing()));
    }
    /// The problem's memory to spare, filled by a source.
    const Buffer &staged(const PlaneSource &source);

    std::size_t pixels() const { return std::size_t(workspace.grid().width) * workspace.grid().height; }

    Device &device;
    Workspace workspace;
    Problem problem;
    Reweighting reweighting;
    std::unique_ptr<MeanCorrection> mean_correction;
};

void PoissonSolver::Implementation::least_squares(const Inputs &images, const PoissonOptions &options,
                                                  PoissonReport &report) {
    Kernels &kernels = kernels_for(options);
    const bool uniform = kernels.weights == Weights::uniform;
    if (!uniform)
        problem.make_base_weights(kernels, options.weigh_by_variance, options.largest_weight);
    const bool settles = !uniform && report.alpha < least_alpha_of_means;
    if (settles && report.alpha > 0)
        report.alpha = std::max(report.alpha, least_alpha_of_squares);
    if (!uniform)
        report.alpha = std::min(report.alpha, largest_alpha_of_weights);
    problem.use_least_squares_weights(kernels, report.alpha);

    LinearSolver::Request request;
    request.method = options.method != LinearMethod::automatic ? options.method
                     : uniform                                 ? LinearMethod::multigrid
                                                               : LinearMethod::pcg;
    request.tolerance = options.tolerance > 0 ? options.tolerance : default_tolerance;
    request.iterations = options.iterations > 0 ? options.iterations : default_iterations(request.method);
    request.damping = options.damping;
    request.smooths_after = true;
    request.may_drift = settles;
    if (options.noise_share > 0 && options.weigh_by_variance && options.alpha_from_variances &&
        request.method == LinearMethod::pcg && problem.noise() > 0) {
        request.tolerance = std::sqrt(options.noise_share);
        request.noise = problem.noise();
    }
    const double norm = images.start ? problem.norm_of_right_side(kernels) : 0;
    problem.start(images);
    if (uniform && images.start)
        problem.remove_mean(kernels);
    const auto right_side = [&](Planes group) -> const Buffer & { return problem.make_right_side(kernels, group); };
    const LinearReport linear =
        workspace.linear.solve(kernels, request, workspace.groups(), right_side, problem.u(), norm);
    if (settles)
        Pieces(workspace).settle_means(problem, problem.base_data());
    report.method = method_name(request.method);
    report.iterations = linear.iterations;
    report.converged = linear.converged;
    report.residuals = linear.residuals;
    report.objective = problem.squared_norm(kernels);
}

void PoissonSolver::Implementation::absolute_values(const Inputs &images, const PoissonOptions &options,
                                                    PoissonReport &report) {
    Kernels &kernels = kernels_for(options);
    problem.make_base_weights(kernels, false);
    reweighting.run(kernels, problem, report.alpha, images, options, report);
    report.method = fmt::format(
        "irls, {}", method_name(options.method == LinearMethod::automatic ? LinearMethod::pcg : options.method));
    if (options.keep_mean) {
        if (!mean_correction)
            mean_correction = std::make_unique<MeanCorrection>(workspace);
        // Which pixels an equation holds is told by the weights that the correction replaces.
        problem.find_held(kernels);
        report.correction = mean_correction->add(kernels, problem);
    }
}

PoissonReport PoissonSolver::Implementation::solve(const Inputs &images, const PoissonOptions &options,
                                                   const std::function<Buffer &()> &result, const Call &all_read) {
    const auto begin = std::chrono::steady_clock::now();
    for (auto &[weights, kernels] : workspace.all_kernels())
        reset_times(kernels->all());
    PoissonReport report;
    workspace.set_any_kernels(weights_for(options, false));
    problem.import(images, report);
    if (options.alpha_from_variances || options.weigh_by_variance)
        problem.import_variances(images, options);
    if (all_read)
        all_read();
    report.alpha = options.alpha_from_variances ? problem.alpha_from_variances(options.alpha) : options.alpha;
    const bool l2 = options.norm == PoissonNorm::l2;
    if (!l2 && options.alpha_from_variances && report.alpha > 0)
        report.alpha = std::max(report.alpha, least_alpha_of_absolute_values);
    report.alpha = std::min(report.alpha, largest_alpha);
    if (l2)
        least_squares(images, options, report);
    else
        absolute_values(images, options, report);
    report.converged = report.converged && std::isfinite(report.objective);
    // Uniform weights keep the mean. So does L1 without a data term: no equation but this one tells it.
    const bool keep_mean = !problem.anything_missing() && (l2 ? !options.weigh_by_variance : report.alpha == 0);
    report.filled = problem.compose(kernels_for(options), images, keep_mean, result());
    finish(device);
    report.device_bytes = peak_device_bytes(device);
    report.seconds = seconds_since(begin);
    for (auto &[weights, kernels] : workspace.all_kernels())
        add_times(report.kernels, kernels->all());
    return report;
}

const Buffer &PoissonSolver::Implementation::staged(const PlaneSource &source) {
    const Buffer &buffer = problem.spare();
    const auto mapping = buffer.map(Access::write);
    for (std::uint32_t c = 0; c < workspace.channels; ++c)
        source(c, mapping.as<float>() + c * pixels());
    return buffer;
}

PoissonSolver::PoissonSolver(Device &device, std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                             Precision precision, std::uint32_t together)
    : make_([=, &device] {
          return std::make_unique<Implementation>(device, width, height, channels, precision, together);
      }),
      width_(width), height_(height), channels_(channels) {
    if (width == 0 || height == 0)
        throw Error(ExitCode::usage, fmt::format("an image of {} x {} pixels has nothing to solve", width, height));
    if (channels == 0 || channels > most_channels)
        throw Error(ExitCode::usage, fmt::format("{} channels; the solver takes 1 to {}", channels, most_channels));
    implementation_ = make_();
}

PoissonSolver::~PoissonSolver() = default;

std::uint32_t PoissonSolver::width() const { return width_; }
std::uint32_t PoissonSolver::height() const { return height_; }
std::uint32_t PoissonSolver::channels() const { return channels_; }

PoissonReport PoissonSolver::run(const std::function<PoissonReport(Implementation &)> &solve) {
    // An error takes it along.
    std::unique_ptr<Implementation> implementation = implementation_ ? std::move(implementation_) : make_();
    PoissonReport report = solve(*implementation);
    implementation_ = std::move(implementation);
    return report;
}

namespace {

/// Images of one kind from those of another, image by image.
template <class To, class From, class Convert>
PoissonImages<To> converted(const PoissonImages<From> &images, Convert convert) {
    if (images.one_variance)
        throw Error(ExitCode::usage,
                    "one variance for all channels is for buffers that are made when they are asked for");
    return {convert(images.primal),      convert(images.dx),         convert(images.dy),
            convert(images.direct),      convert(images.start),      convert(images.primal_variance),
            convert(images.dx_variance), convert(images.dy_variance)};
}

} // namespace

PoissonReport PoissonSolver::solve(const DeviceImages &images, const PoissonOptions &options, Buffer &result) {
    check(images, options);
    const std::size_t bytes = std::size_t(width_) * height_ * channels_ * sizeof(float);
    const auto check_size = [&](const Buffer &buffer) {
        if (buffer.bytes() < bytes)
            throw Error(ExitCode::usage,
                        fmt::format("{} has {} bytes; an image of {} x {} pixels and {} channels has {}", buffer.name(),
                                    buffer.bytes(), width(), height(), channels(), bytes));
    };
    check_size(result);
    using Input = std::function<const Buffer &()>;
    const auto inputs = converted<Input>(images, [&](const Buffer *buffer) {
        if (buffer)
            check_size(*buffer);
        return buffer ? Input([buffer]() -> const Buffer & { return *buffer; }) : Input();
    });
    return run([&](Implementation &i) { return i.solve(inputs, options, [&]() -> Buffer & { return result; }, {}); });
}

PoissonReport PoissonSolver::solve(const BufferSources &images, const PoissonOptions &options, Buffer &result) {
    check(images, options);
    return run([&](Implementation &i) { return i.solve(images, options, [&]() -> Buffer & { return result; }, {}); });
}

PoissonReport PoissonSolver::solve(const ImageSources &images, const PoissonOptions &options, const PlaneSink &result,
                                   const std::function<void()> &all_read) {
    check(images, options);
    if (!result)
        throw Error(ExitCode::usage, "a reconstruction needs a function that takes its planes");
    return run([&](Implementation &i) {
        using Input = std::function<const Buffer &()>;
        const auto inputs = converted<Input>(images, [&i](const PlaneSource &source) {
            return source ? Input([&i, &source]() -> const Buffer & { return i.staged(source); }) : Input();
        });
        // compose() may write where it reads the direct image.
        PoissonReport report = i.solve(
            inputs, options, [&i]() -> Buffer & { return i.problem.spare(); }, all_read);
        const auto mapping = i.problem.spare().map(Access::read);
        for (std::uint32_t c = 0; c < channels_; ++c)
            result(c, mapping.as<float>() + c * i.pixels());
        return report;
    });
}

PoissonReport PoissonSolver::solve(const HostImages &images, const PoissonOptions &options, float *result) {
    const std::size_t pixels = std::size_t(width_) * height_;
    const auto sources = converted<PlaneSource>(images, [pixels](const float *image) {
        return image ? PlaneSource([image, pixels](std::uint32_t channel, float *plane) {
            std::memcpy(plane, image + channel * pixels, pixels * sizeof(float));
        })
                     : PlaneSource();
    });
    return solve(sources, options, [&](std::uint32_t channel, const float *plane) {
        std::memcpy(result + channel * pixels, plane, pixels * sizeof(float));
    });
}

void PoissonSolver::compile(Device &device, const PoissonOptions &options, std::uint32_t channels, Precision precision,
                            const KernelLibrary::Progress &progress) {
    // The device keeps the programs, which is what takes the time.
    Kernels(device, precision, channels, weights_for(options, false), progress);
}

} // namespace gradus
