#include "planning/photon_pilot.h"

#include "methods/gradient_photon_mapper.h"
#include "planning/make_method.h"
#include "runtime/film/metrics.h"
#include "runtime/scene/roughness.h"
#include "runtime/scene/traits.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace gradus {

namespace {

/// What flips a render's seed to those of the two passes: no render of small seeds has them.
constexpr std::uint64_t seed_flips[] = {std::uint64_t(1) << 62, std::uint64_t(1) << 63};
/// A pass has one light path for so many samples of the render, within bounds.
constexpr std::uint64_t samples_a_light_path = 32, fewest_light_paths = 10'000, most_light_paths = 300'000;

/// Costs over that of a ray of a path tracer with all that is done at the vertex that it meets. From the times of
/// passes of 100 000 light paths on six scenes, of which they tell each within a quarter: rays of camera and light
/// paths; of shifts; of walks; and what photons and pairs cost beside rays.
constexpr double ray_cost = 1.4, offset_cost = 3, walk_cost = 1.5, photon_cost = 3, pair_cost = 4;

double cost_of(const Statistics &statistics) {
    double cost = photon_cost * double(statistics.photons) + pair_cost * double(statistics.photon_pairs);
    for (const auto &[kind, count] : statistics.rays)
        cost += double(count) * (kind == "offset" ? offset_cost : kind == "walk" ? walk_cost : ray_cost);
    return cost;
}

const float *channel_of(const Image &image, const std::string &layer, const char *color) {
    return image.find(layer + color)->values.data();
}

/// The mean of some numbers and its standard error where they are independent.
struct Mean {
    double sum = 0, squares = 0;
    std::size_t count = 0;
    void add(double value) {
        sum += value;
        squares += value * value;
        ++count;
    }
    double mean() const { return sum / double(count); }
    double error() const { return std::sqrt(std::max(0.0, squares / double(count) - mean() * mean()) / double(count)); }
};

} // namespace

bool may_ask_for_photons(const Scene &scene, const RenderOptions &options) {
    const GatheringSurfaces surfaces = gathering_surfaces(scene, options.gather_roughness);
    return reason_against_gpm(scene).empty() && !surfaces.passed.empty() && !surfaces.gathered.empty() &&
           !scene.emitters.empty() && scene.settings.max_depth != 0 && scene.settings.max_depth != 1;
}

PhotonErrors estimate_photon_errors(const Image &photons_1, const Image &photons_2, const Image &paths_1,
                                    const Image &paths_2) {
    PhotonErrors errors;
    const ReferencePairs references = {{&photons_1, &photons_2}, {&paths_1, &paths_2}};
    errors.gpm = estimate_errors(photons_1, photons_2, references).gpt;
    const PilotErrors paths = estimate_errors(paths_1, paths_2, references);
    errors.pt = paths.pt;
    errors.gpt = paths.gpt;
    Mean difference, bias;
    for (const char *color : {"R", "G", "B"}) {
        const std::vector<double> weights = relative_weights(references, color);
        const float *g_1 = channel_of(photons_1, "primal.", color), *g_2 = channel_of(photons_2, "primal.", color);
        const float *w_1 = channel_of(paths_1, "primal.", color), *w_2 = channel_of(paths_2, "primal.", color);
        const float *b_1 = channel_of(photons_1, "bias.", color), *b_2 = channel_of(photons_2, "bias.", color);
        for (std::size_t i = 0; i < weights.size(); ++i) {
            difference.add(weights[i] * (double(g_1[i]) - w_1[i]) * (double(g_2[i]) - w_2[i]));
            // No more than what is seen: where few photons have come it is noise.
            const double scale = std::sqrt(weights[i]);
            bias.add(std::clamp(scale * b_1[i], -1.0, 1.0) * std::clamp(scale * b_2[i], -1.0, 1.0));
        }
    }
    errors.gpm_radius = std::max(bias.mean(), 0.0) + 2 * bias.error();
    errors.missed = std::max(difference.mean() - 3 * difference.error() - errors.gpm_radius, 0.0);
    return errors;
}

PhotonPilot run_photon_pilot(Device &device, const Scene &scene, const RenderOptions &options, const Pilot &pilot,
                             std::uint64_t samples_per_pixel) {
    PhotonPilot found;
    Scene one_pass = scene;
    one_pass.settings.samples_per_pixel = 1;
    RenderOptions with = options;
    const auto [width, height] = image_size(scene.film);
    const std::uint64_t pixels = std::uint64_t(width) * height;
    const std::uint64_t samples = std::min(samples_per_pixel, most_light_paths * samples_a_light_path);
    with.photons = std::clamp(samples * pixels / samples_a_light_path, fewest_light_paths, most_light_paths);
    if (options.photons > 0)
        with.photons = std::min(with.photons, options.photons);
    with.layers = with.bias_layer = true;
    with.aov = false;
    Image passes[2];
    double cost = 0, samples_done = 0;
    for (int half = 0; half < 2; ++half) {
        with.seed = options.seed ^ seed_flips[half];
        const std::unique_ptr<Method> method = make_method("gpm", device, one_pass, with);
        while (method->render_batch()) {
        }
        passes[half] = method->image();
        const Statistics statistics = method->statistics();
        cost += cost_of(statistics);
        found.photons += 0.5 * double(statistics.photons);
        samples_done += double(statistics.samples);
        found.seconds += statistics.render_seconds;
    }
    found.film_pixels = std::uint64_t(scene.film.width) * scene.film.height;
    found.light_paths = with.photons;
    found.cost = cost / samples_done;
    found.errors = estimate_photon_errors(passes[0], passes[1], pilot.halves[0], pilot.halves[1]);
    return found;
}

} // namespace gradus
