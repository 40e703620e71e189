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
    void pause_at(std::uint64_t samples) override { method_->pause_at(samples); }
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

// Photons are taken where they are estimated to have less than so much of the error: costs of so unlike methods are
// known less well, and their bias does not fall as noise does.
constexpr double least_gain_of_photons = 0.5;
// A render that ends by time has more samples than this; it is decided on as if it had those.
constexpr std::uint64_t most_samples = 1u << 20;
constexpr double samples_of_endless = 1024;
// Passes are a render's samples: with fewer, radii hardly shrink, and nobody knows alpha.
constexpr double fewest_passes = 16;

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

PhotonChoice choose_by_photons(MethodChoice choice, const PhotonPilot &pilot, std::uint64_t samples,
                               const RenderOptions &options) {
    const PhotonErrors &errors = pilot.errors;
    choice.pilot_seconds += pilot.seconds;
    choice.estimates["gpm"] = {errors.gpm, pilot.cost};
    const double decided = samples > most_samples ? samples_of_endless : double(samples);
    const double cost = choice.estimates.at(choice.method).cost;
    const double of_paths = choice.method == "gpt" ? errors.gpt : errors.pt;
    const double paths = of_paths * 0.5 * pilot_samples / decided + errors.missed;
    const double photons = errors.gpm * pilot.cost / (decided * cost) + errors.gpm_radius;
    if (!(std::isfinite(paths) && std::isfinite(photons) && photons < least_gain_of_photons * paths))
        return {choice, samples, 0};
    choice.reason = fmt::format("at equal cost the relMSE of gpm is estimated at {:.2g} of that of {}", photons / paths,
                                choice.method);
    if (errors.missed > 0.5 * paths)
        choice.reason += ", which misses light";
    choice.method = "gpm";
    choice.gain = 0;
    // As many light paths as cost as much; passes of as many as LightPaths takes, or fewer where these would be few.
    const double all = double(samples) * cost / pilot.cost * double(pilot.light_paths);
    const double usual =
        options.photons > 0
            ? double(options.photons)
            : std::min(double(pilot.light_paths) * photons_a_pass(pilot.film_pixels) / std::max(pilot.photons, 1.0),
                       most_light_paths_a_pass(pilot.film_pixels));
    const double pass = options.photons > 0 ? usual : std::clamp(all / fewest_passes, double(pilot.light_paths), usual);
    PhotonChoice found{choice, std::max<std::uint64_t>(1, std::uint64_t(all / pass)), std::uint64_t(pass)};
    found.choice.reason += fmt::format("; passes of {} light paths, as many as cost as much", found.light_paths);
    return found;
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
    const Pilot pilot = run_pilot(*method);
    PhotonChoice found{choose_by_pilot(pilot), samples, 0};
    if (!options.error && may_ask_for_photons(scene, options)) // gpm does not tell its error
        found = choose_by_photons(found.choice, run_photon_pilot(device, scene, options, pilot), samples, options);
    if (found.choice.method == "gpt") {
        method->restart(0, samples);
        return chosen(found.choice, std::move(method));
    }
    method.reset(); // its memory before the other's
    Scene of_choice = scene;
    of_choice.settings.samples_per_pixel = found.samples;
    RenderOptions with = options;
    with.photons = found.light_paths > 0 ? found.light_paths : options.photons;
    return chosen(found.choice, make_method(found.choice.method, device, of_choice, with));
}

} // namespace gradus
