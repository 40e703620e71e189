#include "bench/solver/problem.h"

#include "runtime/device/program.h"
#include "tests/support/poisson_reference.h"

#include <fmt/format.h>

#include <chrono>

namespace gradus::bench {

Inputs make_inputs(std::uint32_t width, std::uint32_t height) {
    auto inputs = std::make_shared<testing::PoissonProblem>(testing::make_poisson_problem(width, height, channels, 1));
    for (std::vector<float> *unused :
         {&inputs->clean, &inputs->primal_variance, &inputs->dx_variance, &inputs->dy_variance})
        *unused = {};
    return inputs;
}

Problem::Problem(const Settings &settings, Inputs inputs)
    : device_(settings.device), inputs_(std::move(inputs)),
      solver_(settings.device, inputs_->width, inputs_->height, channels) {
    const std::size_t bytes = inputs_->primal.size() * sizeof(float);
    primal_ = Buffer(device_, "primal", inputs_->primal.data(), bytes);
    dx_ = Buffer(device_, "dx", inputs_->dx.data(), bytes);
    dy_ = Buffer(device_, "dy", inputs_->dy.data(), bytes);
    result_ = Buffer(device_, "result", bytes);
}

Problem::Run Problem::timed(const std::function<PoissonReport()> &solve) {
    Run run;
    run.seconds = seconds_of(device_, [&] { run.report = solve(); });
    return run;
}

Problem::Run Problem::solve(const PoissonOptions &options) {
    DeviceImages images;
    images.primal = &primal_;
    images.dx = &dx_;
    images.dy = &dy_;
    return timed([&] { return solver_.solve(images, options, result_); });
}

Problem::Run Problem::solve_on_host(const PoissonOptions &options) {
    image_.resize(inputs_->primal.size());
    return timed([&] { return solver_.solve(inputs_->images(), options, image_.data()); });
}

const std::vector<float> &Problem::image() {
    image_.resize(inputs_->primal.size());
    result_.read(image_.data(), image_.size() * sizeof(float));
    return image_;
}

const std::vector<double> &Problem::reference() {
    if (!reference_)
        reference_ = testing::solve_directly(*inputs_, chart_alpha);
    return *reference_;
}

double Problem::error(const std::vector<float> &image) { return testing::relative_error(image, reference()); }

double Problem::residual(const std::vector<float> &image) const {
    return testing::relative_residual(*inputs_, chart_alpha, testing::unit_weights(*inputs_),
                                      testing::to_double(image));
}

std::string Problem::name() const { return fmt::format("{}x{}", inputs_->width, inputs_->height); }

PoissonOptions l2_steps(LinearMethod method, int steps) {
    PoissonOptions options;
    options.norm = PoissonNorm::l2;
    options.alpha = chart_alpha;
    options.method = method;
    options.iterations = steps;
    options.tolerance = 1e-12;
    return options;
}

double seconds_of(const std::function<void()> &work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double seconds_of(Device &device, const std::function<void()> &work) {
    finish(device);
    return seconds_of([&] {
        work();
        finish(device);
    });
}

} // namespace gradus::bench
