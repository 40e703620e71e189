#include "planning/automatic_method.h"
#include "planning/make_method.h"

#include "methods/gradient_path_tracer.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace gradus {

namespace {

/// A method and how it came to be the one.
class ChosenMethod final : public Method {
  public:
    ChosenMethod(std::unique_ptr<Method> method, MethodChoice choice)
        : method_(std::move(method)), choice_(std::move(choice)) {}

    std::uint64_t total_samples() const override { return method_->total_samples(); }
    std::uint64_t done_samples() const override { return method_->done_samples(); }
    bool render_batch() override { return method_->render_batch(); }
    Image image() override { return method_->image(); }
    Image last_image() override { return method_->last_image(); }
    Statistics statistics() const override {
        Statistics statistics = method_->statistics();
        statistics.choice = choice_;
        return statistics;
    }

  private:
    std::unique_ptr<Method> method_;
    MethodChoice choice_;
};

/// Without a pilot. Where gpt gains nothing it loses at most what its samples cost more; where it gains, it gains more.
MethodChoice choose_by_rule(const RenderSettings &settings) {
    MethodChoice choice;
    const bool only_lights = settings.max_depth == 0 || settings.max_depth == 1;
    choice.method = only_lights ? "pt" : "gpt";
    choice.reason = only_lights ? "paths see nothing but lights, which are not reconstructed"
                                : "the render is too short for a pilot; gpt gains more where it gains than it loses "
                                  "where it does not";
    return choice;
}

} // namespace

MethodChoice choose_by_pilot(const Pilot &pilot) {
    MethodChoice choice;
    const double samples = 0.5 * pilot_samples;
    choice.pilot_samples = pilot_samples;
    choice.pilot_seconds = pilot.seconds;
    choice.estimates["pt"] = {pilot.errors.pt * samples, pilot.costs.pt};
    choice.estimates["gpt"] = {pilot.errors.gpt * samples, pilot.costs.gpt};
    const double pt = pilot.errors.pt * pilot.costs.pt, gpt = pilot.errors.gpt * pilot.costs.gpt;
    choice.method = "pt";
    if (!std::isfinite(pt) || !std::isfinite(gpt)) {
        choice.reason = "the pilot's errors are not finite";
    } else if (pilot.errors.pt == 0) {
        choice.reason = "the pilot saw no noise, so there is nothing to gain";
    } else if (gpt == 0) {
        choice.method = "gpt";
        choice.reason = "the pilot's reconstructions have no error";
    } else {
        choice.gain = pt / gpt;
        choice.method = choice.gain > 1 ? "gpt" : "pt";
        choice.reason =
            fmt::format("at equal cost the relMSE of gpt is estimated at {:.2g} of that of pt", 1 / choice.gain);
    }
    return choice;
}

std::unique_ptr<Method> make_automatic_method(Device &device, const Scene &scene, const RenderOptions &options) {
    const auto chosen = [&](const MethodChoice &choice, std::unique_ptr<Method> method) {
        return std::make_unique<ChosenMethod>(std::move(method), choice);
    };
    const std::uint64_t samples = scene.settings.samples_per_pixel;
    if (!has_room_for_pilot(samples)) {
        const MethodChoice choice = choose_by_rule(scene.settings);
        return chosen(choice, make_method(choice.method, device, scene, options));
    }
    auto method = std::make_unique<GradientPathTracer>(device, scene, options);
    if (options.on_pilot)
        options.on_pilot(pilot_samples);
    const MethodChoice choice = choose_by_pilot(run_pilot(*method));
    if (choice.method == "gpt") {
        method->restart(0, samples);
        return chosen(choice, std::move(method));
    }
    method.reset(); // its memory before the other's
    return chosen(choice, make_method(choice.method, device, scene, options));
}

} // namespace gradus
