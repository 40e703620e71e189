#include "methods/photons/light_paths.h"

#include "kernels/shared/light_vertex.h"
#include "kernels/shared/tables.h"
#include "methods/path_stages.h"
#include "runtime/error.h"

#include <algorithm>
#include <limits>
#include <string_view>
#include <utility>

namespace gradus {

using namespace lib_float;

namespace {

// The pilot: enough light paths to know the mean number of photons to a hundredth or so, few against a pass. Renders
// count from 0 and do not come to its numbers.
constexpr std::uint32_t pilot_paths = 1u << 14;
constexpr std::uint64_t pilot_first = std::uint64_t(1) << 63;
// Photons of a pass, for each pixel of the film. A camera path is as random as photons are: by what glass does, by
// edges in its pixel and by lights that it samples. More photons than these take time that more passes use better,
// fewer leave the pass to its launches.
constexpr double photons_a_pixel = 5, least_photons = 1 << 14, largest_photons = 1e6;
// Where light hardly reaches a surface.
constexpr double most_paths_a_photon = 4;
constexpr std::uint64_t most_photons = 1u << 31; // tables are numbered with 32 bits

// Russian roulette is played from the first vertex on, so that photons are of like power, unless the scene asks for
// none: by a depth that no path has.
constexpr std::uint32_t roulette_from = 1, no_roulette = 0xFFFFFFFFu, beyond_all_paths = 1u << 16;

/// By the whole film: a crop is a part of its image.
std::uint64_t film_pixels(const Session &session) { return std::uint64_t(session.film.width) * session.film.height; }

bool has_vertices(const Session &session) { return session.has("TRAIT_LIGHT_VERTICES"); }

std::uint32_t gathers_at(const Bsdf &bsdf, double roughness) {
    return !gathers_photons(bsdf, roughness)       ? gathers_nowhere
           : bsdf_kind_traits(bsdf.kind).transmits ? gathers_around
                                                   : gathers_in_front;
}

std::vector<std::uint32_t> gathers_by_material(const Scene &scene, double roughness) {
    std::vector<std::uint32_t> gathers;
    for (const Bsdf &bsdf : material_records(scene)) {
        gathers.push_back(gathers_nowhere);
        for_each_part(scene, bsdf, [&](const Bsdf &part) { gathers.back() = gathers_at(part, roughness); });
    }
    return gathers;
}

/// The same of where light paths leave photons: wherever any part of a blend gathers them, and of the blend itself,
/// which is what is known of a surface that a moved photon has met.
std::vector<std::uint32_t> keeps_by_material(const Scene &scene, double roughness) {
    std::vector<std::uint32_t> keeps = gathers_by_material(scene, roughness);
    const std::vector<Bsdf> records = material_records(scene);
    const std::size_t first_part = keeps.size() - scene.blended.size();
    for (std::size_t i = 0; i < first_part; ++i) {
        if (records[i].blend == no_blend)
            continue;
        std::uint32_t most = gathers_nowhere;
        for_each_part(scene, records[i], [&](const Bsdf &part) {
            const std::uint32_t at = gathers_at(part, roughness);
            most = most == gathers_around || at == gathers_nowhere ? most : at;
        });
        keeps[i] = most;
        for_each_part(scene, records[i],
                      [&](const Bsdf &part) { keeps[first_part + std::size_t(&part - scene.blended.data())] = most; });
    }
    return keeps;
}

StageDeclaration photons_stage(const char *step, std::vector<std::string> numbers) {
    return {.name = std::string("photons ") + step,
            .file = "photons",
            .entry = std::string("photons_") + step,
            .definitions = {{"PARTITION_CHUNK", std::to_string(partition_chunk)}},
            .numbers = std::move(numbers)};
}

/// The records of vertices, and how many elements each has in these tables (kernels/shared/light_vertex.h).
std::vector<std::pair<const char *, std::uint32_t>> vertex_tables(const Session &session) {
    std::vector<std::pair<const char *, std::uint32_t>> tables;
    if (!session.has("TRAIT_LIGHT_VERTICES"))
        return tables;
    tables = {{"light_vertices", light_vertex_stride}, {"light_vertex_marks", light_vertex_mark_stride}};
    if (session.textured_columns() > 0)
        tables.emplace_back("light_vertex_textures", session.textured_columns());
    return tables;
}

/// Vertices and photons go to tables of the consumers, which are not known yet.
StageDeclaration with_vertices(StageDeclaration stage) {
    stage.numbers.push_back("to_vertex");
    stage.tables = {{"light_vertices", "light_path"},
                    {"light_vertex_marks", "photon_place"},
                    {"light_vertex_textures", "light_path"}};
    return stage;
}

StageDeclaration emit_stage(const Session &session) {
    return with_vertices({.name = "emit",
                          .is_wanted = session.scene.light_count > 0,
                          .numbers = {"first_row", "first_slot", "first_path_low", "first_path_high"}});
}

StageDeclaration scatter_stage() {
    StageDeclaration stage = with_vertices({.name = "scatter",
                                            .definitions = {{"LEAVES_PHOTONS", "1"}},
                                            .by_kind = true,
                                            .numbers = {"first", "to", "to_photon"}});
    stage.tables.insert(stage.tables.end(), {{"photon", "light_path"}, {"photon_origin", "light_path"}});
    return stage;
}

/// The first surface, where no photon is left.
StageDeclaration scatter_first_stage(bool is_wanted) {
    return with_vertices({.name = "scatter first",
                          .file = "scatter",
                          .definitions = {{"LEAVES_PHOTONS", "0"}},
                          .by_kind = true,
                          .is_wanted = is_wanted,
                          .numbers = {"first", "to"}});
}

// Light paths that have met their first surface are a phase of their own where that leaves no photon.
constexpr std::uint32_t first_phase = 1;

BinLayout bin_layout(const Session &session, bool is_first_apart) {
    return {.phases = is_first_apart ? 2u : 1u, .kinds = std::uint32_t(session.scene.kinds.size())};
}

StageDeclaration order_stage() {
    StageDeclaration stage = photons_stage("order", {});
    stage.tables = {{"photon_origin", "light_path"}, {"photon_order", "photon_place"}};
    return stage;
}

/// The tables of light paths in flight, and what orders their photons.
TableList own_tables(const Session &session, const Wavefront &paths) {
    return joined(
        paths.ray_tables(),
        {{.name = "light_path",
          .columns = std::uint32_t(has_vertices(session) ? light_path_columns : light_path_vertex),
          .alternates = true},
         {.name = "photon_place", .rows = RowsOf::one, .multiple = pilot_paths, .is_uint = true, .grows = true},
         {.name = "photon_chunk",
          .rows = RowsOf::one,
          .multiple = chunks_of(pilot_paths),
          .is_uint = true,
          .grows = true},
         {.name = "photon_total", .rows = RowsOf::one, .is_uint = true}});
}

} // namespace

double photons_a_pass(std::uint64_t film_pixels) {
    return std::clamp(photons_a_pixel * double(film_pixels), least_photons, largest_photons);
}

double most_light_paths_a_pass(std::uint64_t film_pixels) { return most_paths_a_photon * photons_a_pass(film_pixels); }

LightPaths::LightPaths(Session &session, Stages &consumers, const Scene &scene, const RenderOptions &options,
                       Direct direct)
    : session_(session), consumers_(consumers), wanted_(options.photons),
      first_depth_(direct == Direct::left_out ? 2 : 1), layout_(bin_layout(session, direct == Direct::left_out)),
      emit_(stages_.add(emit_stage(session))),
      paths_(session, stages_, layout_, {{"FRESH_APART", layout_.phases > 1 ? "1" : "0"}}, {"bins_of_phase", "fresh"},
             true),
      scatter_(stages_.add(scatter_stage())), scatter_first_(stages_.add(scatter_first_stage(layout_.phases > 1))),
      count_(stages_.add(photons_stage("count", {"rows"}))), scan_(stages_.add(photons_stage("scan", {"chunks"}))),
      place_(stages_.add(photons_stage("place", {"rows"}))), order_(stages_.add(order_stage())) {
    if (wanted_ > std::numeric_limits<std::int32_t>::max())
        throw Error(ExitCode::usage, "there can be 2^31 - 1 light paths a pass at most");
    session.add_scene_buffer("material_gathers", gathers_by_material(scene, options.gather_roughness));
    session.add_scene_buffer("material_keeps", keeps_by_material(scene, options.gather_roughness));
    const TableList list = own_tables(session, paths_);
    const std::uint32_t batch =
        choose_batch_size(session.device, session.options.batch_size,
                          wanted_ ? wanted_ : std::uint64_t(most_light_paths_a_pass(film_pixels(session))), list,
                          session.options.precision);
    own_.emplace(session.device, list, table_rows(session, batch, batch), session.options.precision);

    // The numbers that our kernels know are not those of the consumers'.
    const auto numbers = session.numbers;
    const bool plays_roulette = session.numbers.at("roulette_depth") < beyond_all_paths;
    session.numbers["capacity"] = batch;
    session.numbers["light_roulette_depth"] = plays_roulette ? roulette_from : no_roulette;
    session.numbers["photon_rows"] = 0; // attach() and trace() say it
    stages_.build(session, *own_);
    session.numbers = numbers;
    session.numbers["photon_rows"] = 0;
    paths_.attach(*own_);
}

TableList LightPaths::tables() const {
    const double usual = 1.1 * photons_a_pass(film_pixels(session_)),
                 rows = wanted_ ? std::min(double(wanted_), usual) : usual;
    const auto photons = odd_lines(std::uint32_t(rows));
    TableList list = {
        {.name = "photon",
         .rows = RowsOf::one,
         .multiple = photons,
         .columns = std::uint32_t(has_vertices(session_) ? photon_columns : photon_before),
         .grows = true},
        {.name = "photon_origin",
         .rows = RowsOf::one,
         .multiple = photons,
         .columns = photon_origin_columns,
         .grows = true},
        {.name = "photon_order", .rows = RowsOf::one, .multiple = photons, .is_uint = true, .grows = true}};
    for (const auto &[name, elements] : vertex_tables(session_)) // records: one column
        list.push_back({.name = name,
                        .rows = RowsOf::one,
                        .multiple = 3 * photons * elements,
                        .is_uint = std::string_view(name) == "light_vertex_marks",
                        .grows = true});
    return list;
}

void LightPaths::attach(Tables &tables) {
    tables_ = &tables;
    bind_tables();
}

void LightPaths::bind_tables() {
    const auto rows = std::uint32_t(tables_->rows_of("photon"));
    session_.numbers["photon_rows"] = rows;
    consumers_.set("photon_rows", rows);
    stages_.set("photon_rows", rows);
    scatter_.bind("photon", (*tables_)["photon"]);
    for (Stage *stage : {&scatter_, &order_})
        stage->bind("photon_origin", (*tables_)["photon_origin"]);
    order_.bind("photon_order", (*tables_)["photon_order"]);
    for (Stage *stage : {&emit_, &scatter_, &scatter_first_})
        for (const auto &[name, elements] : vertex_tables(session_))
            stage->bind(name, (*tables_)[name]);
}

std::uint32_t LightPaths::paths_a_pass() {
    if (wanted_)
        return std::uint32_t(wanted_);
    if (paths_a_pass_ == 0) {
        const double stored = trace(pilot_first, pilot_paths);
        light_paths_ = photons_ = 0;
        paths_a_pass_ =
            std::uint32_t(std::clamp(photons_a_pass(film_pixels(session_)) * pilot_paths / std::max(stored, 1.0), 1.0,
                                     most_light_paths_a_pass(film_pixels(session_))));
    }
    return paths_a_pass_;
}

std::uint32_t LightPaths::trace(std::uint64_t first_path, std::uint32_t count) {
    rows_ = vertices_ = 0;
    if (!emit_.is_wanted() || session_.max_depth() <= first_depth_)
        return 0;
    light_paths_ += count;
    if (count > own_->rows_of("photon_place")) {
        own_->grow("photon_place", count);
        own_->grow("photon_chunk", chunks_of(count));
    }
    const std::uint64_t traced_before = session_.rays["extension"];
    step_all(first_path, count);
    rays_ += session_.rays["extension"] - traced_before;
    const std::uint32_t stored = put_in_order(count);
    photons_ += stored;
    return stored;
}

void LightPaths::step_all(std::uint64_t first_path, std::uint32_t count) {
    paths_.begin_pass(count);
    for (;;) {
        std::uint32_t slot;
        const Range fresh = paths_.refill(slot);
        make_room_for_vertices(std::uint64_t(vertices_) + fresh.count);
        emit_.run(fresh.count, {{"first_row", fresh.first},
                                {"first_slot", slot},
                                {"first_path_low", std::uint32_t(first_path)},
                                {"first_path_high", std::uint32_t(first_path >> 32)},
                                {"to_vertex", vertices_}});
        vertices_ += session_.has("TRAIT_LIGHT_STARTS") ? fresh.count : 0;
        if (!paths_.is_alive())
            return;
        paths_.trace();
        const Hits &hits = paths_.partition(
            {{"bins_of_phase", std::uint32_t(2 * session_.scene.kinds.size())}, {"fresh", paths_.vertices()}});
        make_room(std::uint64_t(rows_) + hits.count());
        make_room_for_vertices(std::uint64_t(vertices_) + hits.count());
        paths_.advance();
        for (std::uint32_t phase = 0; phase < layout_.phases; ++phase)
            for (std::size_t kind = 0; kind < layout_.kinds; ++kind)
                scatter(hits, phase, kind);
    }
}

void LightPaths::scatter(const Hits &hits, std::uint32_t phase, std::size_t kind) {
    const Range rows = hits.kind(phase, kind);
    const std::uint32_t from = hits.place(rows.first);
    if (phase == first_phase) {
        scatter_first_.run_kind(kind, rows.count, {{"first", from}, {"to", rows.first}, {"to_vertex", vertices_}});
    } else {
        scatter_.run_kind(kind, rows.count,
                          {{"first", from}, {"to", rows.first}, {"to_photon", rows_}, {"to_vertex", vertices_}});
        const bool leaves_none = bsdf_kind_is_dirac(session_.scene.kinds[kind]) && !session_.has("TRAIT_BLENDS");
        rows_ += leaves_none ? 0 : rows.count;
    }
    vertices_ += has_vertices(session_) ? rows.count : 0;
}

std::uint32_t LightPaths::put_in_order(std::uint32_t count) {
    const std::uint32_t chunks = chunks_of(count);
    count_.run(chunks, {{"rows", count}});
    scan_.run(1, {{"chunks", chunks}});
    std::uint32_t photons = 0;
    Buffer::Reading reading = (*own_)["photon_total"].start_read(&photons, sizeof photons);
    place_.run(chunks, {{"rows", count}});
    order_.run(rows_);
    reading.wait();
    return photons;
}

void LightPaths::make_room(std::uint64_t rows) {
    if (rows <= tables_->rows_of("photon"))
        return;
    if (rows > most_photons)
        throw Error(ExitCode::device, "these are more photons a pass than there can be; ask for fewer light paths");
    const std::uint32_t more = odd_lines(std::uint32_t(std::min(rows + rows / 4, most_photons)));
    for (const char *table : {"photon", "photon_origin", "photon_order"})
        tables_->grow(table, more);
    bind_tables();
}

/// For so many records of vertices.
void LightPaths::make_room_for_vertices(std::uint64_t records) {
    if (!has_vertices(session_))
        return;
    std::uint64_t largest = 0;
    for (const auto &[name, elements] : vertex_tables(session_))
        largest = std::max<std::uint64_t>(largest, elements);
    if (records * largest > most_photons)
        throw Error(ExitCode::device, "light paths have more vertices than there can be; ask for fewer of them");
    if (records * light_vertex_stride <= tables_->rows_of("light_vertices"))
        return;
    const auto more = std::uint32_t(records + records / 2);
    for (const auto &[name, elements] : vertex_tables(session_))
        tables_->grow(name, more * elements);
    bind_tables();
}

std::vector<StageTime> LightPaths::times() const {
    std::vector<StageTime> times = stages_.times();
    for (StageTime &row : times)
        row.name = "light paths, " + row.name;
    return times;
}

} // namespace gradus
