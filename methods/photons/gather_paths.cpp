#include "methods/photons/gather_paths.h"

#include "kernels/shared/tables.h"
#include "methods/path_stages.h"
#include "methods/photons/pass_photons.h"
#include "runtime/trace/opacity.h"

#include <fmt/format.h>

namespace gradus {

using namespace lib_float;

namespace {

// Bins of `classify` that are no new vertices: paths that left the scene, and lights found after a gather point.
constexpr std::uint32_t escaped_bins = 2, found_bin = 1;
constexpr std::uint32_t goes_on = 0, gathers = 1; // the phases

StageDeclaration gather_stage(bool features, bool planes) {
    return {.name = "gather",
            .definitions = {{"FEATURES", features ? "1" : "0"}, {"BY_SLOT", planes ? "1" : "0"}},
            .by_kind = features,
            .numbers = {"first", "to"}};
}

StageDeclaration wanted_if(StageDeclaration stage, bool is_wanted) {
    stage.is_wanted = stage.is_wanted && is_wanted;
    return stage;
}

StageDeclaration defined_as(StageDeclaration stage, const char *definition, bool value) {
    stage.definitions[definition] = fmt::format("{:d}", value);
    return stage;
}

} // namespace

TraitMap gather_traits(const Scene &scene, const RenderOptions &options) {
    return {{"TRAIT_LOBE_LEVELS", options.sampler == RenderOptions::Sampler::sobol},
            {"TRAIT_OPACITY", options.all_traits || has_passable_shapes(scene)}};
}

GatherPaths::GatherPaths(Session &session, Stages &stages, const Scene &scene, const RenderOptions &options,
                         bool planes)
    : session_(session), samples_lights_(!options.direct_photons),
      // What the camera features of a gather point need, where `shade` does not see it.
      features_(needs_features(options) && options.direct_photons), planes_(planes),
      has_smooth_(has_smooth_surface(scene, options)),
      camera_(stages.add(defined_as(camera_stage(), "PLANES", planes))), far_clip_(stages.add(far_clip_stage(session))),
      connect_(stages.add(wanted_if(connect_stage(), has_smooth_ || samples_lights_))),
      paths_(session, stages,
             {.escaped = escaped_bins, .phases = 2, .kinds = std::uint32_t(session.scene.kinds.size())},
             {{"GATHER", "1"}, {"FOUND_BIN", fmt::format("{}u", found_bin)}}, {"gathered_first", "gathered_end"}),
      escape_(stages.add(defined_as(escape_stage(session), "DIRECT_APART", planes))),
      emission_(stages.add(defined_as(emission_stage(session), "DIRECT_APART", planes))),
      travel_(stages.add(wanted_if({.name = "travel", .numbers = {"first"}}, has_smooth_))),
      gather_(stages.add(gather_stage(features_, planes))),
      shade_(stages.add(wanted_if(shade_stage(false), has_smooth_ || samples_lights_))) {
    session.add_scene_buffer("material_kind", material_kinds(scene, options.gather_roughness, gathers_photons));
    session.numbers["bins_of_phase"] = static_cast<std::uint32_t>(2 * session.scene.kinds.size());
}

TableList GatherPaths::tables() const {
    return joined(paths_.tables(), {{.name = "gather",
                                     .rows = planes_ ? RowsOf::slot : RowsOf::path,
                                     .columns = session_.vertex_columns(gather_columns),
                                     .is_cleared = planes_},
                                    {.name = "travelled", .rows = RowsOf::slot, .is_cleared = true}});
}

void GatherPaths::trace(std::uint32_t paths, std::uint32_t first_pixel, std::uint64_t pass,
                        const std::function<void(const Hits &)> &gathered) {
    paths_.begin_pass(paths);
    gathered_ = {};
    for (;;) {
        begin_camera_paths(camera_, paths_, first_pixel, pass);
        if (!paths_.is_alive())
            break;
        paths_.trace();
        far_clip_.run(paths_.rays());
        connect_.run(paths_.vertices(), {{"first", 0}});
        const Hits &hits = paths_.partition({{"gathered_first", gathered_.first}, {"gathered_end", gathered_.end()}});
        escape_.run(hits.escaped().count, {{"first", hits.escaped().first}});
        emission_.run(hits.escaped(found_bin).count, {{"first", hits.escaped(found_bin).first}});
        for (const std::uint32_t phase : {goes_on, gathers})
            for (std::size_t kind = 0; kind < paths_.kinds(); ++kind)
                run_on_places(emission_, hits, hits.emitting(phase, kind));
        step(hits);
        gathered(hits);
    }
}

/// The surfaces that the partition found are the newest vertices, and some of them gather points.
void GatherPaths::step(const Hits &hits) {
    // Paths that sample lights at their gather point go on by one ray, others not at all.
    paths_.advance(samples_lights_ ? hits.count() : hits.phase(goes_on).count);
    gathered_ = samples_lights_ ? hits.phase(gathers) : Range();
    run_on_places(travel_, hits, hits.phase(goes_on));
    for (std::size_t kind = 0; kind < paths_.kinds(); ++kind) {
        run_shade(shade_, hits, hits.kind(goes_on, kind), kind);
        const Range rows = hits.kind(gathers, kind);
        const LaunchNumbers places = {{"first", hits.place(rows.first)}, {"to", rows.first}};
        gather_.run_kind(features_ ? kind : 0, rows.count, places);
        if (samples_lights_)
            run_shade(shade_, hits, rows, kind);
    }
}

Range GatherPaths::gather_points(const Hits &hits, std::size_t kind) const { return hits.kind(gathers, kind); }

} // namespace gradus
