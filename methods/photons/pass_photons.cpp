#include "methods/photons/pass_photons.h"

#include "kernels/shared/scene_records.h"
#include "methods/path_stages.h"
#include "methods/photons/seen_distances.h"
#include "runtime/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace gradus {

using namespace lib_float;

namespace {

// The largest radius where pixels say it, as a share of the scene's diameter: through a mirror or towards the horizon a
// pixel may cover much.
constexpr double largest_share = 0.05;
// Lines of cells that a gather point reaches over on average, at most.
constexpr double most_lines_reached = 64;
// Cells have the median radius for an edge, or more where they would hold fewer photons than this, but not so many
// radii. About that share of the photons is where the camera looks. Measured in the Cornell box and slab-and-ball.
constexpr double photons_a_cell = 4, most_radii_a_cell = 4, seen_share = 1.0 / 3;

bool any_bsdf(const Scene &scene, double roughness, bool rough) {
    bool found = false;
    for_each_bsdf(scene, [&](const Bsdf &bsdf) { found = found || gathers_photons(bsdf, roughness) == rough; });
    return found;
}

LightPaths::Direct direct_of(const RenderOptions &options) {
    return options.direct_photons ? LightPaths::Direct::photons : LightPaths::Direct::left_out;
}

std::uint32_t photon_rows(const LightPaths &paths) { return paths.tables().front().multiple; }

/// The edge that cells have at least, so that gather points of these radii reach over few enough of them.
double least_edge(const std::vector<double> &radii, double edge) {
    const auto lines = [&] {
        double sum = 0;
        for (const double radius : radii)
            sum += (2 * radius / edge + 1) * (2 * radius / edge + 1);
        return sum / double(radii.size());
    };
    while (lines() > most_lines_reached)
        edge *= 1.25;
    return edge;
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

double length_of(const float *record, int field) {
    return std::hypot(record[field], record[field + 1], record[field + 2]);
}

/// Before anything is compiled.
Session &checked_for_light(Session &session) {
    if (session.scene.light_count == 0)
        throw Error(ExitCode::usage, "there is no light in the scene, and so no photon to gather");
    return session;
}

} // namespace

double radius_shrinkage(std::uint64_t pass, double alpha) {
    // The product of (k + alpha) / (k + 1) for k = 1 to pass.
    const double n = double(pass);
    return std::exp(std::lgamma(n + 1 + alpha) - std::lgamma(1 + alpha) - std::lgamma(n + 2));
}

const char *accuracy_of_photons(const RenderOptions &options) {
    return accuracy_name(options.radius_alpha < 1 ? Accuracy::consistent : Accuracy::neither);
}

void count_radii(Statistics &statistics, std::uint64_t pass, bool begins, const GatherRadii &radii) {
    if (begins)
        statistics.last_radii = {};
    statistics.last_radii.points += radii.points;
    statistics.last_radii.sum += radii.sum;
    if (pass == 0)
        statistics.first_radii = statistics.last_radii;
}

bool has_smooth_surface(const Scene &scene, const RenderOptions &options) {
    return any_bsdf(scene, options.gather_roughness, false);
}

const Scene &checked_for_gathering(const Scene &scene, const RenderOptions &options) {
    if (!any_bsdf(scene, options.gather_roughness, true))
        throw Error(ExitCode::usage, fmt::format("no surface is rough enough to gather photons at: roughness {} or "
                                                 "more; --gather-roughness asks for less, --method pt for none",
                                                 options.gather_roughness));
    if (options.radius && !(options.radius->value > 0 && std::isfinite(options.radius->value)))
        throw Error(ExitCode::usage, "the radius to gather photons from must be above 0");
    if (!(options.radius_alpha > 0 && options.radius_alpha <= 1))
        throw Error(ExitCode::usage, "the radius shrinks by an alpha above 0 and up to 1");
    return scene;
}

PassPhotons::PassPhotons(Session &session, Stages &stages, const Scene &scene, const RenderOptions &options,
                         double pixel_widths, bool halves)
    : options_(options), has_halves_(halves), stages_(stages),
      light_paths_(checked_for_light(session), stages, scene, options, direct_of(options)),
      map_(session, stages, photon_rows(light_paths_)) {
    set_radius(session, options.radius.value_or(RenderOptions::GatherRadius{pixel_widths, false}));
}

void PassPhotons::set_radius(Session &session, RenderOptions::GatherRadius radius) {
    const double diameter = session.scene.scene_diameter;
    const float *camera = session.scene.camera.data();
    const double pixel = std::sqrt(length_of(camera, camera_right_x) * length_of(camera, camera_down_x));
    // Of an orthographic camera pixels are as wide at any distance.
    const double width = std::sqrt(length_of(camera, camera_step_right_x) * length_of(camera, camera_step_down_x));
    const double slope = radius.of_scene ? 0 : radius.value * pixel;
    const double largest = diameter * (radius.of_scene ? radius.value : largest_share);
    const double start = radius.of_scene ? largest : std::min(radius.value * width, largest);
    const std::vector<double> distances = seen_distances(session);
    const double middle = median(distances);
    const auto radius_at = [&](double distance) { return std::clamp(slope * distance, start, largest); };
    std::vector<double> radii(distances.size());
    std::ranges::transform(distances, radii.begin(), radius_at);
    median_radius_ = radius_at(middle);
    least_edge_ = least_edge(radii, median_radius_);
    seen_area_ =
        double(session.film.width) * session.film.height * std::pow(std::max(pixel * middle, width), 2) / seen_share;
    session.reals["radius_slope"] = slope;
    session.reals["radius_start"] = start;
    session.reals["radius_most"] = largest;
    session.reals["radius_scale"] = 1; // begin_pass() says it
    session.reals["flux_scale"] = 1;   // once it is known how many light paths a pass has
}

TableList PassPhotons::tables() const { return joined(light_paths_.tables(), map_.tables()); }

void PassPhotons::attach(Tables &tables) {
    light_paths_.attach(tables);
    map_.attach(tables);
}

void PassPhotons::begin(std::uint64_t pass) {
    if (pass == pass_)
        return;
    if (paths_a_pass_ == 0) {
        paths_a_pass_ = light_paths_.paths_a_pass();
        stages_.set_real("flux_scale", std::numbers::inv_pi / double(paths_a_pass_));
    }
    // Each half of the passes has radii of its own: as if it were all there is.
    const std::uint64_t of_half = has_halves_ ? pass / 2 : pass;
    const double scale = std::sqrt(radius_shrinkage(of_half, options_.radius_alpha));
    stages_.set_real("radius_scale", scale);
    const std::uint32_t photons = light_paths_.trace(pass * paths_a_pass_, paths_a_pass_);
    const double sparse = std::sqrt(seen_area_ * photons_a_cell / std::max(photons, 1u));
    map_.build(light_paths_.rows(), photons,
               std::max(scale * least_edge_, std::min(sparse, most_radii_a_cell * scale * median_radius_)));
    pass_ = pass;
}

} // namespace gradus
