#include "methods/photon_mapper.h"

#include "kernels/shared/scene_records.h"
#include "kernels/shared/tables.h"
#include "methods/path_stages.h"
#include "methods/seen_distance.h"
#include "runtime/error.h"
#include "runtime/seconds_since.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

namespace gradus {

using namespace lib_float;

namespace {

// Bins of `classify` that are no new vertices: paths that left the scene, and lights found after a gather point.
constexpr std::uint32_t escaped_bins = 2, found_bin = 1;
constexpr std::uint32_t goes_on = 0, gathers = 1; // the phases

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
    for_each_bsdf(scene, [&](const Bsdf &bsdf) { found = found || is_rough(bsdf, roughness) == rough; });
    return found;
}

const Scene &checked(const Scene &scene, const RenderOptions &options) {
    if (!any_bsdf(scene, options.gather_roughness, true))
        throw Error(ExitCode::usage, fmt::format("no surface is rough enough to gather photons at: roughness {} or "
                                                 "more; --gather-roughness asks for less, --method pt for none",
                                                 options.gather_roughness));
    if (!(options.radius.value > 0) || !std::isfinite(options.radius.value))
        throw Error(ExitCode::usage, "the radius to gather photons from must be above 0");
    if (!(options.radius_alpha > 0 && options.radius_alpha <= 1))
        throw Error(ExitCode::usage, "the radius shrinks by an alpha above 0 and up to 1");
    return scene;
}

/// What the camera features of a gather point need, where `shade` does not see it.
bool gather_leaves_features(const RenderOptions &options) { return options.aov && options.direct_photons; }

StageDeclaration gather_stage(const RenderOptions &options) {
    const bool features = gather_leaves_features(options);
    return {.name = "gather",
            .definitions = {{"FEATURES", features ? "1" : "0"}},
            .by_kind = features,
            .numbers = {"first", "to"}};
}

StageDeclaration wanted_if(StageDeclaration stage, bool is_wanted) {
    stage.is_wanted = stage.is_wanted && is_wanted;
    return stage;
}

LightPaths::Direct direct_of(const RenderOptions &options) {
    return options.direct_photons ? LightPaths::Direct::photons : LightPaths::Direct::left_out;
}

std::uint32_t photon_rows(const LightPaths &paths) { return paths.tables().front().multiple; }

double length_of(const float *record, int field) {
    return std::hypot(record[field], record[field + 1], record[field + 2]);
}

} // namespace

double radius_shrinkage(std::uint64_t pass, double alpha) {
    // The product of (k + alpha) / (k + 1) for k = 1 to pass.
    const double n = double(pass);
    return std::exp(std::lgamma(n + 1 + alpha) - std::lgamma(1 + alpha) - std::lgamma(n + 2));
}

PhotonMapper::PhotonMapper(Device &device, const Scene &scene, const RenderOptions &options)
    : options_(options), session_(device, checked(scene, options), options, {}),
      has_smooth_(any_bsdf(scene, options.gather_roughness, false)), camera_(stages_.add(camera_stage())),
      connect_(stages_.add(wanted_if(connect_stage(), has_smooth_ || !options.direct_photons))),
      paths_(session_, stages_,
             {.escaped = escaped_bins, .phases = 2, .kinds = std::uint32_t(session_.scene.kinds.size())},
             {{"GATHER", "1"}, {"FOUND_BIN", fmt::format("{}u", found_bin)}}, {"gathered_first", "gathered_end"}),
      escape_(stages_.add(escape_stage(session_))), emission_(stages_.add(emission_stage(session_))),
      travel_(stages_.add(wanted_if({.name = "travel", .numbers = {"first"}}, has_smooth_))),
      gather_(stages_.add(gather_stage(options))),
      shade_(stages_.add(wanted_if(shade_stage(false), has_smooth_ || !options.direct_photons))),
      light_paths_(session_, stages_, scene, options, direct_of(options)),
      map_(session_, stages_, photon_rows(light_paths_)), pairs_(stages_),
      evaluate_(stages_.add({.name = "photon_evaluate", .by_kind = true, .dirac = DiracKinds::left_out})),
      add_(stages_.add({.name = "gather_add", .numbers = {"first"}})), film_(session_, stages_) {
    if (session_.scene.light_count == 0)
        throw Error(ExitCode::usage, "there is no light in the scene, and so no photon to gather");
    const std::vector<std::uint32_t> kinds = material_kinds(scene, options.gather_roughness);
    session_.scene_buffers.emplace_back(device, "material_kind", kinds.data(), kinds.size() * sizeof(kinds[0]));
    total_ = std::uint64_t(session_.pixels()) * session_.settings.samples_per_pixel;
    allocate();
}

void PhotonMapper::allocate() {
    // Columns of vertices that the scene does not need are the last.
    const std::uint32_t not_needed = session_.has("TRAIT_ANISOTROPIC")       ? 0
                                     : session_.has("TRAIT_SHADING_NORMALS") ? 3
                                                                             : 6;
    TableList list = joined(joined(paths_.tables(), film_.tables()), joined(map_.tables(), pairs_.tables()));
    list = joined(list, light_paths_.tables());
    list.push_back({.name = "gather", .columns = gather_columns - not_needed});
    list.push_back({.name = "travelled", .rows = RowsOf::slot, .is_cleared = true});
    const std::uint32_t batch =
        choose_batch_size(session_.device, options_.batch_size, session_.pixels(), list, options_.precision);
    camera_paths_ =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(batches_a_pass * std::uint64_t(batch), session_.pixels()));
    tables_.emplace(session_.device, list, table_rows(session_, batch, camera_paths_), options_.precision);

    const double diameter = session_.scene.scene_diameter;
    const Box box = box_of(session_.scene);
    double farthest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        farthest = std::max({farthest, std::fabs(box.low[axis]), std::fabs(box.high[axis])});
    const float *camera = session_.scene.camera.data();
    const double pixel = std::sqrt(length_of(camera, camera_right_x) * length_of(camera, camera_down_x));
    const double slope = options_.radius.of_scene ? 0 : options_.radius.value * pixel;
    const double start = options_.radius.of_scene ? options_.radius.value * diameter : 0;
    largest_radius_ = options_.radius.of_scene ? start : largest_share * diameter;
    typical_radius_ = std::clamp(slope * seen_distance(session_), start, largest_radius_);
    session_.reals["radius_slope"] = slope;
    session_.reals["radius_start"] = start;
    session_.reals["radius_most"] = largest_radius_;
    session_.reals["radius_least"] = least_share * std::max(diameter, farthest);
    session_.reals["radius_scale"] = 1; // begin_pass() says it
    session_.reals["flux_scale"] = 1;   // once it is known how many light paths a pass has
    session_.numbers["bins_of_phase"] = static_cast<std::uint32_t>(2 * session_.scene.kinds.size());
    session_.numbers["capacity"] = batch;
    session_.numbers["slots"] = tables_->rows().slots;
    session_.numbers["pair_rows"] = PhotonPairs::pair_rows(batch);
    light_paths_.attach(*tables_);
    stages_.build(session_, *tables_);
    paths_.attach(*tables_);
    map_.attach(*tables_);
    pairs_.attach(*tables_);
    film_.attach(*tables_);
}

void PhotonMapper::begin_pass(std::uint64_t pass) {
    if (paths_a_pass_ == 0) {
        paths_a_pass_ = light_paths_.paths_a_pass();
        stages_.set_real("flux_scale", std::numbers::inv_pi / double(paths_a_pass_));
    }
    const double scale = std::sqrt(radius_shrinkage(pass, options_.radius_alpha));
    stages_.set_real("radius_scale", scale);
    const std::uint32_t photons = light_paths_.trace(pass * paths_a_pass_, paths_a_pass_);
    map_.build(photons, scale * std::max(cell_edge * typical_radius_, largest_radius_ / most_radii_a_cell));
    photons_of_pass_ = pass;
}

bool PhotonMapper::render_batch() {
    if (done_ >= total_)
        return false;
    const auto start = std::chrono::steady_clock::now();
    const std::uint64_t pass = done_ / session_.pixels();
    const auto first_pixel = static_cast<std::uint32_t>(done_ % session_.pixels());
    const std::uint32_t paths = std::min(camera_paths_, session_.pixels() - first_pixel);
    if (session_.max_depth() == 0) { // no path begins, so none sets its slot to zero
        (*tables_)["radiance"].clear();
        if (tables_->has("feature"))
            (*tables_)["feature"].clear();
    } else {
        if (photons_of_pass_ != pass)
            begin_pass(pass);
        trace_camera_paths(paths, first_pixel, pass);
    }
    film_.add(paths, first_pixel);
    finish(session_.device);
    done_ += paths;
    statistics_.samples += paths;
    statistics_.render_seconds += seconds_since(start);
    return done_ < total_;
}

void PhotonMapper::trace_camera_paths(std::uint32_t paths, std::uint32_t first_pixel, std::uint64_t pass) {
    paths_.begin_pass(paths);
    gathered_ = {};
    for (;;) {
        begin_camera_paths(camera_, paths_, first_pixel, pass);
        if (!paths_.is_alive())
            break;
        paths_.trace();
        connect_.run(paths_.vertices(), {{"first", 0}});
        const Hits &hits = paths_.partition({{"gathered_first", gathered_.first}, {"gathered_end", gathered_.end()}});
        escape_.run(hits.escaped().count, {{"first", hits.escaped().first}});
        emission_.run(hits.escaped(found_bin).count, {{"first", hits.escaped(found_bin).first}});
        for (const std::uint32_t phase : {goes_on, gathers})
            for (std::size_t kind = 0; kind < paths_.kinds(); ++kind)
                run_on_places(emission_, hits, hits.emitting(phase, kind));
        step(hits);
        gather_photons(hits);
    }
}

void PhotonMapper::step(const Hits &hits) {
    // Paths that sample lights at their gather point go on by one ray, others not at all.
    const bool samples = !options_.direct_photons;
    paths_.advance(samples ? hits.count() : hits.phase(goes_on).count);
    gathered_ = samples ? hits.phase(gathers) : Range();
    run_on_places(travel_, hits, hits.phase(goes_on));
    for (std::size_t kind = 0; kind < paths_.kinds(); ++kind) {
        run_shade(shade_, hits, hits.kind(goes_on, kind), kind);
        const Range rows = hits.kind(gathers, kind);
        const LaunchNumbers places = {{"first", hits.place(rows.first)}, {"to", rows.first}};
        gather_.run_kind(gather_leaves_features(options_) ? kind : 0, rows.count, places);
        if (samples)
            run_shade(shade_, hits, rows, kind);
    }
}

void PhotonMapper::gather_photons(const Hits &hits) {
    for (std::size_t kind = 0; kind < paths_.kinds(); ++kind) {
        const Range rows = hits.kind(gathers, kind);
        statistics_.gather_points += rows.count;
        statistics_.photon_pairs += pairs_.find(rows, [&](const PairWindow &window) {
            evaluate_.run_kind(kind, window.pairs);
            pairs_.sum(window);
        });
        add_.run(rows.count, {{"first", rows.first}});
    }
}

Image PhotonMapper::image() {
    statistics_.non_finite = 0;
    return film_.image(done_, statistics_.non_finite);
}

Statistics PhotonMapper::statistics() const {
    Statistics s = statistics_;
    s.light_paths = light_paths_.light_paths();
    s.photons = light_paths_.photons();
    s.radius_sum = pairs_.radius_sum();
    s = collected(s, session_, stages_, light_paths_.times());
    return s;
}

std::unique_ptr<Method> make_photon_mapper(Device &device, const Scene &scene, const RenderOptions &options) {
    return std::make_unique<PhotonMapper>(device, scene, options);
}

} // namespace gradus
