#include "planning/automatic_method.h"
#include "planning/make_method.h"

#include "methods/gradient_path_tracer.h"
#include "runtime/scene/roughness.h"
#include "runtime/scene/traits.h"
#include "solver/halves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
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
    std::uint64_t frame_samples() const override { return method_->frame_samples(); }
    bool render_batch() override { return method_->render_batch(); }
    void pause_at(std::uint64_t samples) override { method_->pause_at(samples); }
    Image image() override { return method_->image(); }
    Image last_image() override { return method_->last_image(); }
    Image mean_image() override { return method_->mean_image(); }
    Tracer *tracer() override { return method_->tracer(); }
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
// A render that ends by its error has so many samples, and one that ends by time more: these are decided on as if they
// had those of an endless one.
constexpr std::uint64_t most_samples = 1u << 20;
constexpr double samples_of_endless = 1024;
// Passes are a render's samples: with fewer, radii hardly shrink, and nobody knows alpha.
constexpr double fewest_passes = 16;

// A render until a time asks for photons if it expects so many samples: both halves are a quarter of it then, no tenth,
// for without photons all of it may be for nothing.
constexpr std::uint64_t samples_for_photons = 8 * half_samples;

// Rays that take as long as what gpt does once an image and once a pixel: launching more kernels and the solver's, some
// 50 ms, and solving. From measured times, of two cores.
constexpr double rays_an_image = 1'100'000, rays_a_pixel = 18;

// Over what least squares would leave that knew all variances: reconstructions know them from few samples, and samples
// of path tracing are stratified, with three quarters of the error that their spread tells. Of 16 scenes, measured, at
// equal samples: 1.2 to 3.6 times, and for gpt with guide over pt with guide .8 to 1.3 times the power below.
constexpr double excess_of_weighted = 2, excess_of_uniform = 2.6, spread_of_samples = 0.75;

/// relMSE of gpt over that of pt at equal samples, each as options reconstruct it.
double error_ratio(double left, Reconstruction reconstruction, double samples) {
    if (needs_halves(reconstruction) && samples < 2 * least_half_samples)
        reconstruction = Reconstruction::l1;
    if (reconstruction == Reconstruction::guided) {
        // A guide takes most from where most is to take, the less the more samples there are.
        const double power = std::clamp(0.45 + 0.015 * std::log2(samples / 16), 0.3, 0.7);
        return std::min(std::pow(left / spread_of_samples, power), 1.0);
    }
    return std::min((reconstruction == Reconstruction::weighted ? excess_of_weighted : excess_of_uniform) * left, 1.0);
}

/// relMSE of pt over that of gpt, where pt gets the time of so many samples of gpt.
double gain_of(const RowPilot &pilot, Reconstruction reconstruction, double samples, double pixels) {
    const double paths = samples * pixels;
    const double cost = pilot.costs.gpt + (rays_an_image + rays_a_pixel * pixels) / paths;
    return pilot.costs.pt / (cost * error_ratio(pilot.left, reconstruction, samples));
}

/// In place of a pilot: what those of scenes alike told.
RowPilot assumed_pilot(const Scene &scene, const RenderOptions &options) {
    bool is_rough_everywhere = true, is_mixed = false;
    for_each_bsdf(scene, [&](const Bsdf &bsdf) {
        const bool mixed = bsdf_kind_traits(bsdf.kind).is_mixed;
        is_mixed = is_mixed || mixed;
        is_rough_everywhere = is_rough_everywhere && !mixed && is_rough(bsdf, options.shift_threshold);
    });
    using Kind = Emitter::Kind;
    const auto has = [&](std::initializer_list<Kind> kinds) {
        return std::any_of(scene.emitters.begin(), scene.emitters.end(), [&](const Emitter &emitter) {
            return std::find(kinds.begin(), kinds.end(), emitter.kind) != kinds.end();
        });
    };
    const bool is_outdoors = has({Kind::constant, Kind::environment, Kind::directional});
    // Where none has a size, light that comes straight from them has no noise but at edges, which neighbours do not
    // share.
    const bool casts_soft_shadows = has({Kind::constant, Kind::environment, Kind::area});
    RowPilot pilot;
    pilot.left = !casts_soft_shadows ? 0.3 : !is_rough_everywhere ? 0.2 : is_outdoors ? 0.08 : 0.04;
    pilot.costs = {4.5, is_mixed ? 22.0 : 13.5};
    return pilot;
}

bool sees_only_lights(const RenderSettings &settings) { return settings.max_depth == 0 || settings.max_depth == 1; }

MethodChoice choose_by_rule(const Scene &scene, const RenderOptions &options, std::uint32_t width,
                            std::uint32_t height) {
    const RenderSettings &settings = scene.settings;
    MethodChoice choice;
    if (sees_only_lights(settings)) {
        choice.method = "pt";
        choice.reason = "paths see nothing but lights, which are not reconstructed";
        return choice;
    }
    const double samples = std::max(double(settings.samples_per_pixel), 1.0);
    const double pixels = double(width) * height;
    const bool is_gpt = gain_of(assumed_pilot(scene, options), options.reconstruction, samples, pixels) > 1;
    choice.method = is_gpt ? "gpt" : "pt";
    choice.reason = fmt::format("{} for a pilot; in scenes of such surfaces and lights {} has mostly less error then",
                                std::min(width, height) < 2 ? "one row or column of pixels is too little"
                                                            : "the render is too short",
                                choice.method);
    return choice;
}

} // namespace

MethodChoice choose_by_pilot(const RowPilot &pilot, Reconstruction reconstruction, std::uint64_t samples,
                             std::uint64_t pixels) {
    const double decided = samples >= most_samples ? samples_of_endless : double(samples);
    MethodChoice choice;
    choice.pilot_samples = pilot_samples;
    choice.pilot_seconds = pilot.seconds;
    const double ratio = error_ratio(pilot.left, reconstruction, decided);
    choice.estimates["pt"] = {pilot.error, pilot.costs.pt};
    choice.estimates["gpt"] = {pilot.error * ratio, pilot.costs.gpt};
    const double gain = gain_of(pilot, reconstruction, decided, double(pixels));
    choice.method = "pt";
    if (!std::isfinite(pilot.error) || std::isnan(gain)) {
        choice.reason = "the pilot's errors are not finite";
    } else if (pilot.error == 0) {
        choice.reason = "the pilot saw no noise, so there is nothing to gain";
    } else if (!std::isfinite(gain)) {
        choice.method = "gpt";
        choice.reason = "the pilot's differences have no noise";
    } else {
        choice.gain = gain;
        choice.method = gain > 1 ? "gpt" : "pt";
        choice.reason = fmt::format("at equal cost the relMSE of gpt is estimated at {:.2g} of that of pt", 1 / gain);
    }
    return choice;
}

PhotonChoice choose_by_photons(MethodChoice choice, const PhotonPilot &pilot, std::uint64_t samples,
                               const RenderOptions &options) {
    const PhotonErrors &errors = pilot.errors;
    choice.pilot_seconds += pilot.seconds;
    choice.estimates["gpm"] = {errors.gpm, pilot.cost};
    const double decided = samples >= most_samples ? samples_of_endless : double(samples);
    const double cost = choice.estimates.at(choice.method).cost;
    const double of_paths = choice.method == "gpt" ? errors.gpt : errors.pt;
    const double paths = of_paths * double(half_samples) / decided + errors.missed;
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
    // Not std::clamp(): where pixels have many photons the usual number may be less than the pilot's.
    const double pass =
        options.photons > 0 ? usual : std::min(std::max(all / fewest_passes, double(pilot.light_paths)), usual);
    PhotonChoice found{choice, std::max<std::uint64_t>(1, std::uint64_t(all / pass)), std::uint64_t(pass)};
    found.choice.reason += fmt::format("; passes of {} light paths, as many as cost as much", found.light_paths);
    return found;
}

std::unique_ptr<Method> make_automatic_method(Device &device, const Scene &scene, const RenderOptions &options) {
    const auto chosen = [&](const MethodChoice &choice, std::unique_ptr<Method> method) {
        return std::make_unique<ChosenMethod>(std::move(method), choice);
    };
    const auto [width, height] = image_size(scene.film);
    const std::uint64_t samples = scene.settings.samples_per_pixel, pixels = std::uint64_t(width) * height;
    const bool is_timed = options.time_limit > 0;
    // gpm does not tell its error.
    bool asks_for_photons = !options.error && may_ask_for_photons(scene, options) && has_room_for_halves(samples);
    std::uint32_t rows = rows_of_pilot(width, height, samples, asks_for_photons);
    if (is_timed)
        rows = std::min(rows, rows_of_timed_pilot(width, height));
    if (rows == 0 || sees_only_lights(scene.settings)) {
        const MethodChoice choice = choose_by_rule(scene, options, width, height);
        return chosen(choice, make_method(choice.method, device, scene, options));
    }
    auto method = std::make_unique<GradientPathTracer>(device, scene, options);
    if (options.on_pilot)
        options.on_pilot(pilot_samples);
    const RowPilot of_rows = run_row_pilot(*method, rows);
    // Until a time nobody knows how many samples there will be: at least so many as the pilot's own time tells.
    std::uint64_t expected = samples;
    if (is_timed) {
        expected = std::min(samples, samples_within(options.time_limit, of_rows, rows, height));
        asks_for_photons = asks_for_photons && expected >= samples_for_photons;
    }
    PhotonChoice found{choose_by_pilot(of_rows, options.reconstruction, expected, pixels), samples, 0};
    if (asks_for_photons) {
        const Pilot pilot = run_pilot(*method);
        found.choice.pilot_seconds += pilot.seconds;
        const PhotonPilot of_photons = run_photon_pilot(device, scene, options, pilot, expected);
        found = choose_by_photons(found.choice, of_photons, expected, options);
        // A render until a time goes on beyond what was expected. Only passes of photons are others than samples.
        const double beyond = double(found.samples) * (double(samples) / double(expected));
        found.samples = found.light_paths > 0 ? std::uint64_t(std::min(beyond, 0x1p62)) : samples;
    }
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
