#include "methods/gradient_stages.h"

#include <map>
#include <string>

namespace gradus {

namespace {

/// Where the scene has one BSDF kind, `shift` evaluates it itself.
std::map<std::string, std::string> only_kind(const Session &session) {
    if (session.scene.kinds.size() != 1)
        return {};
    const std::string &kind = session.scene.kinds.front();
    return definitions_of_kind(kind, bsdf_kind_is_dirac(kind));
}

} // namespace

StageDeclaration shift_stage(const Session &session) {
    // Relaxed, its like computations would be packed into short vectors again (kernels/lib/ordered.h), at a third of
    // the speed.
    return {.name = "shift",
            .definitions = only_kind(session),
            .strict = true,
            .numbers = {"first", "stride", "at_first", "own_rows"},
            .tables = {{"own_vertex", "primary_vertex"}}};
}

StageDeclaration shift_alike_stage(const Session &session) {
    StageDeclaration stage = shift_stage(session);
    stage.file = "shift";
    stage.by_kind = true;
    stage.is_wanted = session.scene.kinds.size() > 1;
    return stage;
}

StageDeclaration evaluate_stage(const Session &session) {
    return {.name = "evaluate",
            .by_kind = true,
            .is_wanted = session.scene.kinds.size() > 1,
            .numbers = {"first", "first_line", "stride", "at_first", "own_rows"},
            .tables = {{"own_vertex", "primary_vertex"}}};
}

StageDeclaration weigh_stage(const char *name, const char *at_first, bool is_wanted) {
    return {.name = name,
            .file = "weigh",
            .definitions = {{"AT_FIRST", at_first}},
            .is_wanted = is_wanted,
            .numbers = {"first", "stride", "at_first", "own_rows"},
            .tables = {{"own_vertex", "primary_vertex"}}};
}

StageDeclaration gradient_emission_stage(const char *name, const char *escaped, bool is_wanted) {
    return {.name = name,
            .file = "gradient_emission",
            .definitions = {{"ESCAPED", escaped}},
            .is_wanted = is_wanted,
            .numbers = {"first", "stride"}};
}

StageDeclaration advance_stage(const char *name, const char *apart, bool is_wanted, bool has_textures) {
    StageDeclaration stage = {.name = name,
                              .file = "advance",
                              .definitions = {{"APART", apart}},
                              .is_wanted = is_wanted,
                              .numbers = {"first", "to", "stride"}};
    if (has_textures)
        stage.tables = {{"surface", "offset_surface"}};
    return stage;
}

StageDeclaration count_stage() {
    return {.name = "shift count",
            .file = "shift_count",
            .definitions = {{"PARTITION_CHUNK", std::to_string(partition_chunk)}},
            .numbers = {"first", "rows"}};
}

} // namespace gradus
