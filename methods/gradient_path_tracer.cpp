#include "methods/gradient_path_tracer.h"

#include "kernels/shared/material.h"
#include "kernels/shared/tables.h"
#include "kernels/shared/texture.h"
#include "methods/gradient_stages.h"
#include "methods/path_stages.h"
#include "runtime/seconds_since.h"
#include "runtime/wavefront/sample_parts.h"
#include "runtime/wavefront/segments.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace gradus {

using namespace lib_float;

namespace {

TraitMap gradient_traits(const Scene &scene, const RenderOptions &options) {
    const bool distance = options.all_traits || options.shift_distance > 0;
    bool apart = distance;
    for_each_bsdf(scene, [&](const Bsdf &bsdf) {
        apart = apart || !is_rough(bsdf, options.shift_threshold) || bsdf_kind_traits(bsdf.kind).is_mixed;
    });
    return {{"TRAIT_GRADIENT", 1},
            {"TRAIT_SHARED_START", 1},
            {"TRAIT_APART", apart},
            {"TRAIT_SHIFT_DISTANCE", distance},
            {"TRAIT_AOV", options.all_traits || needs_features(options)},
            {"TRAIT_PART_BITS", part_bits(options, keeps_halves(options))}};
}

/// Whether lights throw pictures.
bool has_pictures(const Session &session) {
    return (session.traits.at("TRAIT_TEXTURED_LIGHTS") & textured_lights_pictures) != 0;
}

} // namespace

GradientPathTracer::GradientPathTracer(Device &device, const Scene &scene, const RenderOptions &options)
    : options_(options), session_(device, scene, options, gradient_traits(scene, options)),
      phases_(phases_of(session_)), camera_(stages_.add(camera_stage())),
      far_clip_(stages_.add(far_clip_stage(session_))),
      primary_(stages_.add({.name = "primary", .numbers = {"first_slot"}})),
      begin_(stages_.add({.name = "gradient_begin", .numbers = {"first_row", "first_slot"}})),
      connect_(stages_.add(connect_stage())),
      gradient_connect_(
          stages_.add({.name = "gradient_connect", .is_wanted = session_.samples_lights(), .numbers = {"first"}})),
      shift_(stages_.add(shift_stage(session_))), shift_alike_(stages_.add(shift_alike_stage(session_))),
      evaluate_(stages_.add(evaluate_stage(session_))), weigh_(stages_.add(weigh_stage("weigh", "1u", true))),
      weigh_apart_(stages_.add(weigh_stage("weigh apart", "0u", session_.has("TRAIT_APART")))),
      paths_(session_, stages_,
             {.escaped = escaped_bins, .phases = phases_.count, .kinds = std::uint32_t(session_.scene.kinds.size())},
             classify_definitions(), {"shifting", "fresh"}),
      escape_(stages_.add(escape_stage(session_))), emission_(stages_.add(emission_stage(session_))),
      gradient_escape_(stages_.add(gradient_emission_stage("gradient escape", "1", session_.has("TRAIT_ENVIRONMENT")))),
      gradient_emission_(stages_.add(gradient_emission_stage("gradient emission", "0", session_.has_emission()))),
      shade_with_offsets_(stages_.add(shade_stage(true))), shade_(stages_.add(shade_stage(false))),
      advance_(stages_.add(advance_stage("advance", "0", true))),
      advance_apart_(stages_.add(
          advance_stage("advance apart", "1", session_.has("TRAIT_APART"), session_.surface_columns() > 0))),
      join_(stages_.add({.name = "join", .by_kind = true, .dirac = DiracKinds::alike, .numbers = {"first", "keeps"}})),
      count_(stages_.add(count_stage())), film_(session_, stages_, options_, "outcome") {
    const std::vector<std::uint32_t> kinds = material_kinds(scene, options.shift_threshold, is_rough);
    session_.add_scene_buffer("material_kind", kinds);
    total_ = session_.pixels() * session_.settings.samples_per_pixel;
    allocate();
}

GradientPathTracer::Phases GradientPathTracer::phases_of(const Session &session) {
    const bool mixed = session.scene.kinds.size() > 1, apart = session.has("TRAIT_APART");
    Phases phases{};
    std::uint32_t next = 0;
    const auto number_if = [&](bool is_needed) { return is_needed ? next++ : ~0u; };
    phases.first = number_if(true);
    phases.first_mixed = number_if(mixed);
    phases.apart = number_if(apart);
    phases.apart_mixed = number_if(apart && mixed);
    phases.joined = number_if(true);
    phases.later = number_if(true);
    phases.count = next;
    return phases;
}

std::map<std::string, std::string> GradientPathTracer::classify_definitions() const {
    const auto text = [](std::uint32_t number) { return fmt::format("{}u", number); };
    return {{"PHASE_FIRST", text(phases_.first)},
            {"PHASE_FIRST_MIXED", text(phases_.first_mixed)},
            {"PHASE_APART", text(phases_.apart)},
            {"PHASE_APART_MIXED", text(phases_.apart_mixed)},
            {"PHASE_JOINED", text(phases_.joined)},
            {"PHASE_LATER", text(phases_.later)},
            {"ESCAPED_FIRST", text(escaped_first)},
            {"ESCAPED_SHIFTING", text(escaped_shifting)},
            {"ESCAPED_LATER", text(escaped_later)},
            {"ESCAPED_BINS", text(escaped_bins)},
            {"MIXED", session_.scene.kinds.size() > 1 ? "1" : "0"}};
}

TableList GradientPathTracer::tables() const {
    const auto with = [&](const char *trait, int columns) { return session_.has(trait) ? std::uint32_t(columns) : 0u; };
    const std::uint32_t offset_columns_used = session_.has("TRAIT_APART") ? offset_columns : offset_state;
    const bool has_tree = session_.has("TRAIT_LIGHT_TREE");
    return {
        {.name = "primary",
         .rows = RowsOf::slot,
         .columns = session_.has("TRAIT_INSTANCES")        ? primary_columns
                    : session_.has("TRAIT_CAMERA_ORIGINS") ? primary_instance
                                                           : primary_origin_x},
        {.name = "primary_vertex", .rows = RowsOf::slot, .columns = session_.vertex_columns(primary_vertex_columns)},
        {.name = "vertex", .columns = session_.vertex_columns(vertex_columns)},
        {.name = "event",
         .columns = has_tree                      ? event_columns
                    : session_.has("TRAIT_APART") ? event_light
                                                  : event_inverse_survival},
        {.name = "offset", .multiple = 4, .columns = offset_columns_used, .alternates = true, .is_cleared = true},
        {.name = "shift", .multiple = 4, .columns = has_tree ? shift_columns : shift_receiver, .is_cleared = true},
        {.name = "shown", .multiple = 4, .columns = has_pictures(session_) ? std::uint32_t(shown_columns) : 0u},
        {.name = "evaluation", .multiple = 8, .columns = evaluation_columns, .is_cleared = true},
        {.name = "link", .multiple = 8, .columns = link_columns},
        {.name = "offset_vertex",
         .multiple = 4,
         .columns = with("TRAIT_APART", int(session_.vertex_columns(offset_vertex_columns))),
         .is_cleared = true},
        {.name = "offset_ray",
         .multiple = 4,
         .columns = with("TRAIT_APART", session_.has("TRAIT_INSTANCES") ? offset_ray_columns : offset_ray_instance)},
        {.name = "offset_surface",
         .multiple = 4,
         .columns = with("TRAIT_APART", int(session_.surface_columns())),
         .is_cleared = true},
        {.name = "offsets_state", .columns = with("TRAIT_APART", 1), .is_uint = true},
        {.name = "outcome", .rows = RowsOf::chunk, .columns = shift_outcomes, .is_uint = true, .is_cleared = true}};
}

void GradientPathTracer::allocate() {
    const TableList list = joined(joined(paths_.tables(), film_.tables()), tables());
    const std::uint32_t width = session_.width(), height = session_.height();
    const std::uint32_t batch =
        choose_batch_size(session_.device, options_.batch_size, total_, list, options_.precision);
    const std::uint64_t paths =
        std::min<std::uint64_t>(batches_a_pass * std::uint64_t(batch), std::max<std::uint64_t>(total_, 1));
    strip_frames_ = static_cast<std::uint32_t>(std::max<std::uint64_t>(paths / session_.pixels(), 1));
    strip_rows_ = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(paths / width, 1, height));
    const bool is_whole = strip_rows_ == height;
    if (is_whole)
        film_.carry_nothing();
    // A strip has the rows beside it too, as far as there are any.
    const std::uint32_t slots = is_whole ? strip_frames_ * session_.pixels() : (strip_rows_ + 2) * width;
    tables_.emplace(session_.device, list, table_rows(session_, batch, slots), options_.precision);
    session_.numbers["capacity"] = batch;
    session_.numbers["slots"] = tables_->rows().slots;
    session_.numbers["chunks_at_most"] = tables_->rows().chunks;
    session_.numbers["bins_of_phase"] = static_cast<std::uint32_t>(2 * session_.scene.kinds.size());
    session_.numbers["strip_first"] = session_.numbers["primary_shift"] = 0;
    session_.numbers["first_sample_low"] = session_.numbers["first_sample_high"] = 0;
    set_divisor(session_, "strip", "strip_pixels", session_.pixels());
    session_.reals["shift_distance"] = options_.shift_distance * session_.scene.scene_diameter;
    stages_.build(session_, *tables_);
    paths_.attach(*tables_);
    film_.attach(*tables_);
}

GradientPathTracer::Strip GradientPathTracer::next_strip() const {
    const std::uint32_t width = session_.width(), height = session_.height();
    const std::uint64_t left = samples_ahead();
    Strip strip;
    strip.first = static_cast<std::uint32_t>(done_ % session_.pixels() / width);
    strip.rows = std::min(strip_rows_, height - strip.first);
    strip.frames = static_cast<std::uint32_t>(
        strip.rows == height ? std::min<std::uint64_t>(strip_frames_, left / session_.pixels()) : 1);
    return strip;
}

/// Tells the stages which pixels the slots belong to.
void GradientPathTracer::begin_pass(const Strip &strip) {
    set_divisor(session_, "strip", "strip_pixels", strip.rows * session_.width());
    session_.numbers["strip_first"] = strip.first;
    session_.numbers["primary_shift"] = strip.first > 0 ? session_.width() : 0;
    const std::uint64_t sample = first_sample_ + done_ / session_.pixels();
    stages_.set("first_sample_low", std::uint32_t(sample));
    stages_.set("first_sample_high", std::uint32_t(sample >> 32));
    for (const char *number : {"strip_pixels", "strip_multiplier", "strip_shift", "strip_first", "primary_shift"})
        stages_.set(number, session_.numbers[number]);
}

/// What the camera sees through each pixel of the strip and of the rows beside it.
void GradientPathTracer::trace_primaries(const Strip &strip) {
    const std::uint32_t width = session_.width();
    const std::uint32_t above = strip.first > 0, below = strip.first + strip.rows < session_.height();
    paths_.begin_pass(strip.frames * (strip.rows + above + below) * width);
    primaries_beside_ += std::uint64_t(above + below) * width;
    for (;;) {
        const std::uint32_t slot = begin_primaries((strip.first - above) * width);
        if (!paths_.is_alive())
            break;
        paths_.trace();
        far_clip_.run(paths_.rays());
        primary_.run(paths_.rays(), {{"first_slot", slot}});
        paths_.drop();
    }
}

std::uint32_t GradientPathTracer::begin_primaries(std::uint32_t first_pixel) {
    const std::uint64_t sample = first_sample_ + done_ / session_.pixels();
    if (all_rows_ == 0)
        return begin_camera_paths(camera_, paths_, first_pixel, sample);
    // A launch for each pair of rows: it lies elsewhere than by its number.
    const std::uint32_t width = session_.width(), pairs = session_.film.crop_height / 2;
    std::uint32_t slot;
    const Range fresh = paths_.refill(slot);
    for (std::uint32_t done = 0; done < fresh.count;) {
        const std::uint32_t pixel = (first_pixel + slot + done) % session_.pixels();
        // The border's rows, which count for nothing here, go with the pairs beside them.
        const std::uint32_t row = pixel / width, in_image = row > session_.border ? row - session_.border : 0;
        const std::uint32_t pair = std::min(in_image / 2, pairs - 1);
        const std::uint32_t end_row = pair + 1 == pairs ? session_.height() : session_.border + 2 * (pair + 1);
        const std::uint32_t count = std::min(fresh.count - done, end_row * width - pixel);
        const auto place = std::uint32_t((2 * std::uint64_t(pair) + 1) * all_rows_ / (2 * pairs)) - 1;
        stages_.set("crop_y", session_.film.crop_y + place - 2 * pair);
        camera_.run(count, {{"first_row", fresh.first + done},
                            {"first_slot", slot + done},
                            {"first_pixel", first_pixel},
                            {"first_sample_low", static_cast<std::uint32_t>(sample)},
                            {"first_sample_high", static_cast<std::uint32_t>(sample >> 32)}});
        done += count;
    }
    return slot;
}

/// How many rows the image has, for all stages.
void GradientPathTracer::set_rows(std::uint32_t rows) {
    session_.film.crop_height = rows;
    session_.numbers["crop_height"] = session_.height();
    session_.numbers["crop_y"] = session_.film.crop_y;
    set_divisor(session_, "pixels", "pixels", session_.pixels());
    for (const char *number : {"crop_height", "crop_y", "pixels", "pixels_multiplier", "pixels_shift"})
        stages_.set(number, session_.numbers[number]);
}

GradientPathTracer::Rows GradientPathTracer::render_rows(std::uint32_t rows, std::uint64_t first_sample,
                                                         std::uint64_t samples) {
    const std::uint32_t all = session_.film.crop_height, width = session_.width(), strip_rows = strip_rows_,
                        strip_frames = strip_frames_;
    const std::uint32_t slots = tables_->rows().slots;
    all_rows_ = all;
    set_rows(rows);
    film_.count_for_own(true); // neighbouring rows may be of different pairs
    strip_rows_ = std::min(session_.height(), slots / width);
    if (strip_rows_ < session_.height()) // with the rows beside
        strip_rows_ = std::max(strip_rows_, 3u) - 2;
    strip_frames_ = std::max(slots / session_.pixels(), 1u);
    restart(first_sample, samples);
    while (render_batch()) {
    }
    Rows found{film_.films(done_), film_.mean(done_), primaries_beside_};
    set_rows(all);
    film_.count_for_own(false);
    all_rows_ = 0;
    strip_rows_ = strip_rows;
    strip_frames_ = strip_frames;
    return found;
}

std::vector<GradientPathTracer::OwnVertices> GradientPathTracer::own_vertices() const {
    const std::uint32_t after_first = std::min(phases_.apart, phases_.joined);
    std::vector<OwnVertices> found = {{"primary_vertex", tables_->rows().slots, 1, newest_.phases(0, after_first),
                                       phases_.first, phases_.first_mixed}};
    if (const Range apart = newest_.phases(after_first, phases_.joined); apart.count > 0)
        found.push_back({"offset_vertex", 4 * tables_->rows().paths, 0, apart, phases_.apart, phases_.apart_mixed});
    return found;
}

/// Takes offset paths that are not connected along with their base paths, and adds the light sampled at their vertices.
void GradientPathTracer::step_offset_paths() {
    const std::uint32_t stride = shifting();
    if (stride == 0)
        return;
    const std::vector<OwnVertices> vertices = own_vertices();
    for (const OwnVertices &own : vertices)
        shift(own, stride);
    const std::size_t capacity = tables_->rows().paths;
    SegmentTable rays,
        links = {&(*tables_)["link"], 8 * capacity, 8 * stride, link_origin_x, link_direction_x, link_open, stride};
    if (tables_->has("offset_ray"))
        rays = {&(*tables_)["offset_ray"], 4 * capacity,         4 * stride, offset_ray_origin_x,
                offset_ray_direction_x,    offset_ray_primitive, stride};
    if (session_.has("TRAIT_INSTANCES"))
        rays.instance = offset_ray_instance;
    const TraceCounts counts = session_.segments.trace(rays, links);
    session_.rays["offset"] += counts.extension + counts.shadow;
    if (tables_->has("offset_surface"))
        paths_.read_materials((*tables_)["offset_ray"], stride, 4, std::uint32_t(4 * capacity),
                              (*tables_)["offset_surface"]);
    for (const OwnVertices &own : vertices) {
        Stage &weigh = own.at_first ? weigh_ : weigh_apart_;
        weigh.bind("own_vertex", (*tables_)[own.table]);
        weigh.run(own.paths.count,
                  {{"first", own.paths.first}, {"stride", stride}, {"at_first", own.at_first}, {"own_rows", own.rows}});
    }
}

/// Where all vertices of a base path's offset paths are of its own BSDF kind, `shift` evaluates that kind itself; else
/// the BSDF services of all kinds answer what it asks.
void GradientPathTracer::shift(const OwnVertices &own, std::uint32_t stride) {
    for (Stage *stage : {&shift_, &shift_alike_, &evaluate_})
        stage->bind("own_vertex", (*tables_)[own.table]);
    const auto launch = [&](const auto &run, Range rows) {
        run(rows.count,
            LaunchNumbers{
                {"first", rows.first}, {"stride", stride}, {"at_first", own.at_first}, {"own_rows", own.rows}});
    };
    const auto generally = [&](std::uint32_t count, LaunchNumbers numbers) { shift_.run(count, numbers); };
    const std::vector<std::string> &kinds = session_.scene.kinds;
    if (kinds.size() == 1)
        return launch(generally, own.paths);
    for (std::size_t kind = 0; kind < kinds.size(); ++kind)
        launch([&](std::uint32_t count, LaunchNumbers numbers) { shift_alike_.run_kind(kind, count, numbers); },
               newest_.kind(own.alike, kind));
    const Range mixed = newest_.phase(own.mixed);
    launch(generally, mixed);
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
        if (!evaluate_.is_first_of_kernel(kind))
            continue; // answered
        // No light connects to a specular vertex.
        const std::uint32_t first_line = bsdf_kind_is_dirac(kinds[kind]) || !session_.samples_lights() ? 4 : 0;
        evaluate_.run_planes(kind, mixed.count, 8 - first_line,
                             {{"first", mixed.first},
                              {"first_line", first_line},
                              {"stride", stride},
                              {"at_first", own.at_first},
                              {"own_rows", own.rows}});
    }
}

/// Adds the light that paths have met. What the camera sees of lights is kept apart.
void GradientPathTracer::find_emission(const Hits &next) {
    const auto add_to = [&](const char *table, Escaped escaped, std::initializer_list<std::uint32_t> phases) {
        escape_.bind("radiance", (*tables_)[table]);
        emission_.bind("radiance", (*tables_)[table]);
        escape_.run(next.escaped(escaped).count, {{"first", next.escaped(escaped).first}});
        for (const std::uint32_t phase : phases)
            for (std::size_t kind = 0; phase < phases_.count && kind < paths_.kinds(); ++kind)
                run_on_places(emission_, next, next.emitting(phase, kind));
    };
    add_to("direct", escaped_first, {phases_.first, phases_.first_mixed});
    add_to("radiance", escaped_later, {phases_.later});
    const std::uint32_t stride = shifting();
    const Range escaped = next.escaped(escaped_shifting);
    gradient_escape_.run(escaped.count, {{"first", escaped.first}, {"stride", stride}});
    // `classify` counts rows as emitting whose offset paths find a light where their base path finds none.
    for (const std::uint32_t phase : {phases_.apart, phases_.apart_mixed, phases_.joined})
        for (std::size_t kind = 0; phase < phases_.count && kind < paths_.kinds(); ++kind) {
            const Range rows = next.emitting(phase, kind);
            gradient_emission_.run(rows.count, {{"first", next.place(rows.first)}, {"stride", stride}});
        }
}

/// Next-event estimation and scattering at the new vertices.
void GradientPathTracer::shade(const Hits &next) {
    for (std::uint32_t phase = 0; phase < phases_.count; ++phase)
        for (std::size_t kind = 0; kind < paths_.kinds(); ++kind)
            run_shade(phase == phases_.later ? shade_ : shade_with_offsets_, next, next.kind(phase, kind), kind);
}

/// Brings offset paths to the new vertices; those that are connected there take the base path's direction. `stride` as
/// it was when they stepped.
void GradientPathTracer::follow(const Hits &next, std::uint32_t stride) {
    const std::uint32_t first_phase = std::min(phases_.apart, phases_.joined);
    const auto advance = [&](Stage &stage, Range rows) {
        stage.run(rows.count, {{"first", next.place(rows.first)}, {"to", rows.first}, {"stride", stride}});
    };
    advance(advance_apart_, next.phases(first_phase, phases_.joined));
    advance(advance_, next.phase(phases_.joined));
    const Range rows = next.phases(first_phase, phases_.joined + 1);
    count_.run(chunks_of(rows.count), {{"first", rows.first}, {"rows", rows.count}});
    for (std::uint32_t phase : {phases_.apart, phases_.apart_mixed, phases_.joined})
        for (std::size_t kind = 0; phase < phases_.count && kind < paths_.kinds(); ++kind) {
            const Range of_kind = next.kind(phase, kind);
            join_.run_kind(kind, of_kind.count, {{"first", of_kind.first}, {"keeps", phase != phases_.joined}});
        }
}

bool GradientPathTracer::render_batch() {
    if (done_ >= total_)
        return false;
    const AddedSeconds render_seconds(statistics_.render_seconds);
    film_.begin();
    const Strip strip = next_strip();
    const std::uint32_t paths = strip.frames * strip.rows * session_.width();
    begin_pass(strip);
    const bool is_black = session_.max_depth() == 0; // no path begins
    if (is_black)
        film_.clear_slots();
    else
        trace_primaries(strip);

    newest_ = Hits();
    paths_.begin_pass(is_black ? 0 : paths);
    for (;;) {
        std::uint32_t slot;
        const Range fresh = paths_.refill(slot);
        begin_.run(fresh.count, {{"first_row", fresh.first}, {"first_slot", slot}});
        if (!paths_.is_alive())
            break;
        paths_.trace();
        const Range later = newest_.phase(phases_.later), joined = newest_.phase(phases_.joined);
        connect_.run(later.count, {{"first", later.first}});
        gradient_connect_.run(joined.count, {{"first", joined.first}});
        step_offset_paths();
        const std::uint32_t stride = shifting();
        const Hits next = paths_.partition({{"shifting", stride}, {"fresh", paths_.vertices()}});
        find_emission(next);
        paths_.advance();
        shade(next);
        follow(next, stride);
        newest_ = next;
    }
    film_.add(strip.first, strip.rows, strip.frames, first_sample_ + done_ / session_.pixels());
    finish(session_.device);
    done_ += paths;
    statistics_.samples += paths;
    return done_ < total_;
}

void GradientPathTracer::restart(std::uint64_t first_sample, std::uint64_t samples_per_pixel) {
    first_sample_ = first_sample;
    done_ = 0;
    total_ = session_.pixels() * samples_per_pixel;
    primaries_beside_ = 0;
    film_.clear(first_sample);
    (*tables_)["outcome"].clear();
    statistics_ = Statistics();
    session_.rays.clear();
    session_.segments.seconds = 0;
    stages_.reset_times();
}

Image GradientPathTracer::make_image(bool layers, bool last) {
    statistics_.non_finite = 0;
    return film_.image(done_, layers, last, statistics_.non_finite);
}

Statistics GradientPathTracer::statistics() const {
    Statistics s = collected(statistics_, session_, stages_);
    film_.add_to(s);
    const Buffer &outcome = (*tables_)["outcome"];
    std::vector<std::uint32_t> found(outcome.bytes() / sizeof(std::uint32_t));
    outcome.read(found.data(), outcome.bytes());
#define GRADUS_OUTCOME_NAME(name, text) #name,
    const char *const names[] = {GRADUS_SHIFT_OUTCOMES(GRADUS_OUTCOME_NAME)};
#undef GRADUS_OUTCOME_NAME
    const std::size_t chunks = tables_->rows().chunks;
    for (std::size_t i = 0; i < shift_outcomes * chunks; ++i)
        s.shifts[names[i / chunks]] += found[i];
    return s;
}

std::unique_ptr<Method> make_gradient_path_tracer(Device &device, const Scene &scene, const RenderOptions &options) {
    return std::make_unique<GradientPathTracer>(device, scene, options);
}

} // namespace gradus
