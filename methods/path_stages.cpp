#include "methods/path_stages.h"

#include "kernels/shared/tables.h"

#include <sys/resource.h>

#include <algorithm>

namespace gradus {

using namespace lib_float;

StageDeclaration camera_stage() {
    return {.name = "camera",
            .numbers = {"first_row", "first_slot", "first_pixel", "first_sample_low", "first_sample_high"}};
}

StageDeclaration far_clip_stage(const Session &session) {
    return {.name = "far_clip", .is_wanted = session.has("TRAIT_FAR_CLIP")};
}

StageDeclaration connect_stage() { return {.name = "connect", .numbers = {"first"}}; }

StageDeclaration escape_stage(const Session &session) {
    return {.name = "escape", .is_wanted = session.has("TRAIT_ENVIRONMENT"), .numbers = {"first"}};
}

StageDeclaration emission_stage(const Session &session) {
    return {.name = "emission", .is_wanted = session.has_emission(), .numbers = {"first"}};
}

StageDeclaration shade_stage(bool with_offsets) {
    return {.name = with_offsets ? "shade with offsets" : "shade",
            .file = "shade",
            .definitions = {{"WITH_OFFSETS", with_offsets ? "1" : "0"}},
            .by_kind = true,
            .textured_file = with_offsets ? "" : "shade_textured",
            .numbers = {"first", "to"}};
}

TableList joined(TableList a, const TableList &b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

TableRows table_rows(const Session &session, std::uint32_t batch, std::uint32_t slots) {
    return {batch, odd_lines(slots), session.pixels(), session.width(), chunks_of(batch), odd_lines(batch)};
}

std::uint32_t begin_camera_paths(Stage &camera, Wavefront &paths, std::uint32_t first_pixel,
                                 std::uint64_t first_sample) {
    std::uint32_t slot;
    const Range fresh = paths.refill(slot);
    camera.run(fresh.count, {{"first_row", fresh.first},
                             {"first_slot", slot},
                             {"first_pixel", first_pixel},
                             {"first_sample_low", static_cast<std::uint32_t>(first_sample)},
                             {"first_sample_high", static_cast<std::uint32_t>(first_sample >> 32)}});
    return slot;
}

void run_on_places(Stage &stage, const Hits &hits, Range rows) {
    stage.run(rows.count, {{"first", hits.place(rows.first)}});
}

void run_shade(Stage &shade, const Hits &hits, Range rows, std::size_t kind) {
    shade.run_kind(kind, rows.count, {{"first", hits.place(rows.first)}, {"to", rows.first}});
}

std::vector<std::uint32_t> material_kinds(const Scene &scene, double threshold,
                                          bool (*counts_as_rough)(const Bsdf &, double)) {
    std::vector<std::uint32_t> kinds;
    for (const Bsdf &bsdf : material_records(scene))
        // Only the parts of a blend have one.
        kinds.push_back(bsdf.blend != no_blend
                            ? kind_none
                            : bsdf_kind_number(bsdf) | (counts_as_rough(bsdf, threshold) ? kind_is_rough : 0) |
                                  (bsdf_kind_traits(bsdf.kind).is_dirac ? kind_is_dirac : 0) |
                                  (bsdf_kind_traits(bsdf.kind).is_mixed ? kind_is_mixed : 0));
    return kinds;
}

Statistics collected(Statistics s, const Session &session, const Stages &stages, const std::vector<StageTime> &more) {
    s.rays = session.rays;
    s.compile_seconds = session.compile_seconds;
    std::uint64_t traced = 0;
    for (const auto &[kind, count] : s.rays)
        traced += count;
    s.stages = stages.times();
    s.stages.insert(s.stages.begin() + (s.stages.empty() ? 0 : 1), {"trace", session.segments.seconds, traced, 0});
    s.stages.insert(s.stages.end(), more.begin(), more.end());
    double known = 0;
    for (const StageTime &row : s.stages)
        known += row.seconds;
    s.stages.push_back({"launch and wait", std::max(0.0, s.render_seconds - known), 0, 0});
    s.device_bytes = peak_device_bytes(session.device);
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    s.peak_host_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
    return s;
}

} // namespace gradus
