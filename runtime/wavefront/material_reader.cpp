#include "runtime/wavefront/material_reader.h"

namespace gradus {

namespace {

StageDeclaration group_stage() {
    return {.name = "material class",
            .file = "material_group",
            .entry = "group_materials",
            .numbers = {"traced_rows"},
            .tables = {{"traced", "ray"}, {"bin", "material_bin"}}};
}

StageDeclaration material_stage(const Session &session, bool of_light_paths) {
    StageDeclaration stage = {
        .name = "material",
        .entry = "read_material",
        .definitions = {{"OF_LIGHT_PATHS", of_light_paths ? "1" : "0"}},
        .numbers = {"first", "traced_rows", "plane_rows", "parameter_texture", "blend_texture", "normal_texture"},
        .tables = {{"traced", "ray"}, {"index", "material_index"}}};
    for (const MaterialClass &one : session.material_classes.classes)
        if (session.is_left_to_material(one))
            stage.variants.push_back(definitions_of(one));
    return stage;
}

} // namespace

MaterialReader::MaterialReader(const Session &session, Stages &stages, bool of_light_paths) : session_(session) {
    if (session.surface_columns() == 0)
        return;
    group_ = &stages.add(group_stage());
    // Offset paths that are apart are four for each path.
    const auto apart = session.traits.find("TRAIT_APART");
    grouping_.emplace(session, stages, "material", std::uint32_t(session.material_classes.classes.size()), RowsOf::path,
                      apart != session.traits.end() && apart->second != 0 ? 4 : 1);
    material_ = &stages.add(material_stage(session, of_light_paths));
}

void MaterialReader::attach(Tables &tables) {
    if (is_wanted())
        grouping_->attach(tables);
}

void MaterialReader::read(const Buffer &rays, std::uint32_t rows, std::uint32_t planes, std::uint32_t table_rows,
                          const Buffer &surface) {
    if (!is_wanted())
        return;
    group_->bind("traced", rays);
    material_->bind("traced", rays);
    material_->bind("surface", surface);
    group_->run(planes * rows, {{"traced_rows", table_rows}});
    grouping_->run(planes * rows);
    std::size_t variant = 0;
    for (std::size_t i = 0; i < session_.material_classes.classes.size(); ++i) {
        const MaterialClass &one = session_.material_classes.classes[i];
        if (!session_.is_left_to_material(one))
            continue;
        const Range places = grouping_->bin(std::uint32_t(i));
        material_->run_kind(variant++, places.count,
                            {{"first", places.first},
                             {"traced_rows", table_rows},
                             {"plane_rows", rows},
                             {"parameter_texture", one.parameter.first},
                             {"blend_texture", one.blend.first},
                             {"normal_texture", one.normal.first}});
    }
}

} // namespace gradus
