#include "planning/tuner.h"
#include "planning/make_method.h"

#include "runtime/device/program.h"
#include "runtime/error.h"
#include "runtime/film/metrics.h"
#include "runtime/seconds_since.h"
#include "runtime/wavefront/table.h"

#include <algorithm>
#include <chrono>

namespace gradus {

namespace {

constexpr double least_gain = 1.03;
constexpr std::uint32_t work_groups[] = {32, 128, 256};
constexpr std::uint64_t endless_samples = std::uint64_t(1) << 30;
/// The image that is compared: some thousand samples, more than the smallest batch takes at once.
constexpr std::uint32_t compared_width = 96, compared_height = 64, compared_samples = 2;

RenderOptions options_of(const Tuning &tuning, int threads) {
    RenderOptions options;
    options.threads = threads;
    options.work_group_size = tuning.work_group_size;
    options.batch_size = tuning.batch_size;
    return options;
}

Image small_image(Device &device, const std::string &name, Scene scene, const Tuning &tuning, int threads) {
    scene.film.width = compared_width;
    scene.film.height = compared_height;
    scene.film.crop_x = scene.film.crop_y = scene.film.crop_width = scene.film.crop_height = 0;
    scene.settings.samples_per_pixel = compared_samples;
    const auto method = make_method(name, device, scene, options_of(tuning, threads));
    while (method->render_batch()) {
    }
    return method->image();
}

/// A render without end.
class Runner {
  public:
    Runner(Device &device, const std::string &name, Scene scene, const Tuning &tuning, int threads) {
        scene.settings.samples_per_pixel = endless_samples;
        method_ = make_method(name, device, scene, options_of(tuning, threads));
        method_->render_batch(); // what is first is slow
        batch_ = std::uint32_t(method_->done_samples() / batches_a_pass);
    }
    /// Paths of a batch.
    std::uint32_t batch() const { return batch_; }
    /// Samples per second over at least so many seconds.
    double rate(double seconds) {
        const auto start = std::chrono::steady_clock::now();
        const std::uint64_t before = method_->done_samples();
        do
            method_->render_batch();
        while (seconds_since(start) < seconds);
        return double(method_->done_samples() - before) / seconds_since(start);
    }

  private:
    std::unique_ptr<Method> method_;
    std::uint32_t batch_;
};

double quantile(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    return values[std::size_t(share * double(values.size() - 1) + 0.5)];
}

bool gains(const TuningTrial &trial) {
    return trial.same_image && !trial.gains.empty() && trial.median_gain >= least_gain &&
           quantile(trial.gains, 0.25) > 1;
}

class Tuner {
  public:
    Tuner(Device &device, const std::string &method, const Scene &scene, const TuningOptions &options)
        : device_(device), method_(method), scene_(scene), options_(options),
          expected_(small_image(device, method, scene, {}, options.threads)),
          defaults_(device, method, scene, {}, options.threads) {}

    TuningTrial judge(const Tuning &tuning) {
        TuningTrial trial{tuning, false, "", {}, 0};
        try {
            trial.same_image = equal_bits(expected_, small_image(device_, method_, scene_, tuning, options_.threads));
            if (trial.same_image) {
                Runner candidate(device_, method_, scene_, tuning, options_.threads);
                for (int turn = 0; turn < options_.turns; ++turn) {
                    const double before = defaults_.rate(options_.seconds_a_turn);
                    trial.gains.push_back(candidate.rate(options_.seconds_a_turn) / before);
                }
                trial.median_gain = quantile(trial.gains, 0.5);
            }
        } catch (const Error &error) { // a work-group that the device does not take, a batch that does not fit
            trial.failure = error.what();
        }
        if (options_.on_trial)
            options_.on_trial(trial);
        return trial;
    }

    /// What the method takes by default, for this scene.
    std::uint32_t default_batch() const { return defaults_.batch(); }

  private:
    Device &device_;
    const std::string &method_;
    const Scene &scene_;
    const TuningOptions &options_;
    const Image expected_;
    Runner defaults_;
};

} // namespace

TuningReport tune(Device &device, const std::string &method, const Scene &scene, const TuningOptions &options) {
    Tuner tuner(device, method, scene, options);
    TuningReport report;
    double best = 1;
    const auto consider = [&](const Tuning &tuning) {
        report.trials.push_back(tuner.judge(tuning));
        const TuningTrial &trial = report.trials.back();
        if (gains(trial) && trial.median_gain > best) {
            best = trial.median_gain;
            report.chosen = tuning;
        }
    };
    const std::uint32_t usual = tuner.default_batch();
    for (const std::uint32_t batch : {usual / 16, usual / 8, usual / 4, usual / 2, usual * 2})
        consider({0, batch});
    const std::uint32_t batch = report.chosen.batch_size;
    for (const std::uint32_t work_group : work_groups)
        consider({work_group, batch});
    return report;
}

TuningTrial try_tuning(Device &device, const std::string &method, const Scene &scene, const Tuning &tuning,
                       const TuningOptions &options) {
    return Tuner(device, method, scene, options).judge(tuning);
}

} // namespace gradus
