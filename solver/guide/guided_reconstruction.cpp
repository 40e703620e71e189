#include "solver/guide/guided_reconstruction.h"

#include "runtime/seconds_since.h"
#include "solver/guide/guided_errors.h"

#include <algorithm>
#include <chrono>
#include <vector>

namespace gradus {

namespace {

Denoiser::Features cleaned(Denoiser &denoiser, const Buffer &features, std::uint32_t width, std::uint32_t height) {
    const auto planes = features.map(Access::read);
    const float *albedo = planes.as<float>(), *normal = albedo + 3 * std::size_t(width) * height;
    return denoiser.cleaned(albedo, normal, width, height);
}

} // namespace

GuidedReconstruction::GuidedReconstruction(Device &device, PoissonSolver &solver, Guide guide, int threads)
    : device_(device), solver_(solver), judge_(device, solver.width(), solver.height()),
      light_(device, solver.width(), solver.height()) {
    if (guide == Guide::denoiser)
        denoiser_ = std::make_unique<Denoiser>("", threads);
    else
        filter_ = std::make_unique<FeatureFilter>(device, solver.width(), solver.height());
}

void GuidedReconstruction::compile(Device &device, const KernelLibrary::Progress &progress) {
    WeightedReconstruction::compile(device, 3, progress);
    solver::compile_guide_kernels(device, progress);
}

void GuidedReconstruction::denoise(const Buffer &primal, const Buffer *solution, const Buffer &direct,
                                   const Denoiser::Features &features, Buffer &guide) {
    const std::size_t values = primal.bytes() / sizeof(float);
    std::vector<float> seen(values), color(values), sum(values);
    if (direct.valid())
        direct.read(seen.data(), primal.bytes());
    for (int turn = 0; turn < (solution ? 2 : 1); ++turn) {
        (turn == 0 ? primal : *solution).read(color.data(), primal.bytes());
        for (std::size_t i = 0; i < values; ++i)
            color[i] += seen[i];
        denoiser_->run(color.data(), features, solver_.width(), solver_.height(), color.data());
        for (std::size_t i = 0; i < values; ++i)
            sum[i] += (color[i] - seen[i]) * (solution ? 0.5f : 1.0f);
    }
    const auto written = guide.map(Access::write);
    std::copy(sum.begin(), sum.end(), written.as<float>());
}

PoissonReport GuidedReconstruction::solve(const HalvedImages &halves, const GuideInputs &inputs, Buffer &result,
                                          SquaredErrors *errors) {
    const bool is_solved = halves[0].dx.valid();
    PoissonReport report;
    std::array<Buffer, 2> solutions;
    if (is_solved) {
        for (Buffer &solution : solutions)
            solution = Buffer(device_, "half_solution", result.bytes());
        report = WeightedReconstruction(device_, solver_).solve_both(halves, solutions);
    } else {
        solutions = {halves[0].primal, halves[1].primal};
        report.method = no_system;
        report.converged = true;
    }

    std::array<Buffer, 2> guides;
    for (Buffer &guide : guides)
        guide = Buffer(device_, "guide", result.bytes());
    const double share = double(halves[0].samples) / double(halves[0].samples + halves[1].samples);
    const std::array<const Buffer *, 2> images{&solutions[0], &solutions[1]}, of_halves{&guides[0], &guides[1]};
    Buffer followed;
    if (filter_)
        filter_->run(images, share, inputs.features, {&guides[0], &guides[1]});
    else {
        const Denoiser::Features features = cleaned(*denoiser_, inputs.features, solver_.width(), solver_.height());
        for (int i = 0; i < 2; ++i)
            denoise(halves[i].primal, is_solved ? &solutions[i] : nullptr, inputs.direct, features, guides[i]);
        // Halves tell how good a denoised image is. One of all samples is a little better.
        ImageMixer mixer(device_);
        Buffer primal(device_, "primal", result.bytes()), solution;
        mixer.mix(halves[0].primal, share, halves[1].primal, 1 - share, primal);
        if (is_solved) {
            solution = Buffer(device_, "solution", result.bytes());
            mixer.mix(solutions[0], share, solutions[1], 1 - share, solution);
        }
        followed = Buffer(device_, "guide", result.bytes());
        denoise(primal, is_solved ? &solution : nullptr, inputs.direct, features, followed);
    }
    std::vector<float> shares;
    judge_.run(images, share, of_halves, result, followed.valid() ? &followed : nullptr, errors ? &shares : nullptr);
    if (filter_)
        light_.run(images, share, result);
    if (errors)
        *errors = errors_of_guided(images, share, of_halves, shares);
    return report;
}

PoissonReport solve_guided(Device &device, PoissonSolver &solver, const HostHalves &halves,
                           const HostGuideInputs &inputs, Guide guide, int threads, float *result) {
    const auto start = std::chrono::steady_clock::now();
    const std::size_t plane = std::size_t(solver.width()) * solver.height();
    GuideInputs uploaded;
    uploaded.features = Buffer(device, "guide_features", FeatureFilter::features * plane * sizeof(float));
    {
        const auto features = uploaded.features.map(Access::write);
        float *to = std::copy_n(inputs.albedo, 3 * plane, features.as<float>());
        to = std::copy_n(inputs.normal, 3 * plane, to);
        std::copy_n(inputs.depth, plane, to);
    }
    const std::size_t bytes = 3 * plane * sizeof(float);
    if (inputs.direct)
        uploaded.direct = Buffer(device, "direct", inputs.direct, bytes);
    Buffer solution(device, "solution", bytes);
    PoissonReport report = GuidedReconstruction(device, solver, guide, threads)
                               .solve(uploaded_halves(device, halves, bytes), uploaded, solution);
    solution.read(result, bytes);
    report.seconds = seconds_since(start);
    return report;
}

} // namespace gradus
