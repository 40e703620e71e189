#include "methods/photons/pass_photons.h"

#include "kernels/shared/scene_records.h"
#include "methods/path_stages.h"
#include "methods/photons/seen_distance.h"
#include "runtime/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gradus {

using namespace lib_float;

namespace {

// The largest radius where pixels say it, as a share of the scene's diameter: through a mirror or towards the horizon a
// pixel may cover much.
constexpr double largest_share = 0.05;
// The least, of the scene's diameter or its distance from the origin: positions are not exact to much less.
constexpr double least_share = 0x1p-18;
// Edge of the grid's cells, in radii; measured.
constexpr double cell_edge = 1;
constexpr double most_radii_a_cell = 8;

bool any_bsdf(const Scene &scene, double roughness, bool rough) {
    bool found = false;
    for_each_bsdf(scene, [&](const Bsdf &bsdf) { found = found || gathers_photons(bsdf, roughness) == rough; });
    return found;
}

LightPaths::Direct direct_of(const RenderOptions &options) {
    return options.direct_photons ? LightPaths::Direct::photons : LightPaths::Direct::left_out;
}

std::uint32_t photon_rows(const LightPaths &paths) { return paths.tables().front().multiple; }

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
    const Bounds &box = session.scene.bounds;
    double farthest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        farthest = std::max({farthest, std::fabs(box.lower[axis]), std::fabs(box.upper[axis])});
    const float *camera = session.scene.camera.data();
    const double pixel = std::sqrt(length_of(camera, camera_right_x) * length_of(camera, camera_down_x));
    // Of an orthographic camera pixels are as wide at any distance.
    const double width = std::sqrt(length_of(camera, camera_step_right_x) * length_of(camera, camera_step_down_x));
    const double slope = radius.of_scene ? 0 : radius.value * pixel;
    const double start = radius.value * (radius.of_scene ? diameter : width);
    largest_radius_ = radius.of_scene ? start : largest_share * diameter;
    typical_radius_ = std::clamp(slope * seen_distance(session), start, largest_radius_);
    session.reals["radius_slope"] = slope;
    session.reals["radius_start"] = start;
    session.reals["radius_most"] = largest_radius_;
    session.reals["radius_least"] = least_share * std::max(diameter, farthest);
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
    map_.build(light_paths_.rows(), photons,
               scale * std::max(cell_edge * typical_radius_, largest_radius_ / most_radii_a_cell));
    pass_ = pass;
}

} // namespace gradus
