#include "runtime/wavefront/wavefront.h"

#include "kernels/shared/tables.h"
#include "runtime/wavefront/segments.h"

#include <algorithm>

namespace gradus {

using namespace lib_float;

namespace {

StageDeclaration classify_stage(const std::map<std::string, std::string> &definitions,
                                const std::vector<std::string> &numbers) {
    StageDeclaration stage;
    stage.name = "classify";
    stage.definitions = definitions;
    stage.numbers = numbers;
    return stage;
}

} // namespace

Wavefront::Wavefront(Session &session, Stages &stages, const BinLayout &layout,
                     const std::map<std::string, std::string> &definitions, const std::vector<std::string> &numbers,
                     bool of_light_paths)
    : session_(session), layout_(layout), fresh_are_alike_(!of_light_paths && !session.has("TRAIT_THIN_LENS")),
      materials_(session, stages, of_light_paths), classify_(stages.add(classify_stage(definitions, numbers))),
      partition_(session, stages, "partition", "") {}

TableList Wavefront::tables() const {
    const std::uint32_t path_columns_used = session_.has("TRAIT_LIGHT_TREE")   ? path_columns
                                            : session_.has("TRAIT_REFRACTION") ? path_receiver
                                                                               : path_eta;
    TableList list = ray_tables();
    list.push_back({.name = "path", .columns = path_columns_used, .alternates = true});
    list.push_back({.name = "shadow", .columns = shadow_columns});
    return list;
}

TableList Wavefront::ray_tables() const {
    const std::uint32_t bins = layout_.bins();
    const std::uint32_t of_rays = session_.has("TRAIT_OPACITY")     ? ray_columns
                                  : session_.has("TRAIT_INSTANCES") ? ray_opacity
                                                                    : ray_instance;
    TableList list = {{.name = "ray", .columns = of_rays, .alternates = true},
                      {.name = "surface", .columns = session_.surface_columns(), .is_cleared = true},
                      {.name = "bin", .is_uint = true},
                      {.name = "index", .is_uint = true},
                      {.name = "chunk_offset", .rows = RowsOf::chunk, .columns = bins, .is_uint = true}};
    for (const TableList &more : {partition_.tables(bins), materials_.tables()})
        list.insert(list.end(), more.begin(), more.end());
    return list;
}

void Wavefront::attach(Tables &tables) {
    tables_ = &tables;
    materials_.attach(tables);
    partition_.attach(tables);
}

void Wavefront::begin_pass(std::uint32_t paths) {
    paths_ = paths;
    begun_ = vertices_ = fresh_ = 0;
}

Range Wavefront::refill(std::uint32_t &slot) {
    slot = begun_;
    fresh_ = std::min(tables_->rows().paths - vertices_, paths_ - begun_);
    begun_ += fresh_;
    return {vertices_, fresh_};
}

void Wavefront::trace() {
    session_.ask_to_go_on();
    const std::size_t rows = tables_->rows().paths;
    SegmentTable connections; // stays empty where paths are connected to no light
    if (tables_->has("shadow"))
        connections = {&(*tables_)["shadow"], rows, vertices_, shadow_origin_x, shadow_direction_x, shadow_open};
    SegmentTable ray{&(*tables_)["ray"], rows, rays(), ray_origin_x, ray_direction_x, ray_primitive};
    if (fresh_are_alike_)
        ray.alike_from = vertices_;
    if (session_.has("TRAIT_INSTANCES"))
        ray.instance = ray_instance;
    if (session_.has("TRAIT_OPACITY"))
        ray.opacity = ray_opacity;
    const TraceCounts counts = session_.segments.trace(ray, connections);
    session_.rays["extension"] += counts.extension;
    session_.rays["shadow"] += counts.shadow;
    if (materials_.is_wanted())
        read_materials((*tables_)["ray"], this->rays(), 1, std::uint32_t(rows), (*tables_)["surface"]);
}

void Wavefront::read_materials(const Buffer &rays, std::uint32_t rows, std::uint32_t planes, std::uint32_t table_rows,
                               const Buffer &surface) {
    materials_.read(rays, rows, planes, table_rows, surface);
}

const Hits &Wavefront::partition(LaunchNumbers numbers) {
    classify_.run(rays(), numbers);
    hits_ = Hits(layout_, partition_.run(rays(), layout_.bins()));
    return hits_;
}

void Wavefront::advance(std::uint32_t rows) {
    vertices_ = rows;
    fresh_ = 0;
    tables_->exchange();
}

} // namespace gradus
