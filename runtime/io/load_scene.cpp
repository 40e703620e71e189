#include "runtime/io/load_scene.h"

#include "runtime/io/diagnostics.h"
#include "runtime/io/document.h"
#include "runtime/io/file_search.h"
#include "runtime/io/scene_builder.h"
#include "runtime/phases.h"

namespace gradus {

LoadedScene load_scene(const std::string &path, const LoadOptions &options) {
    Diagnostics diagnostics(options.strict);
    FileFinder finder;
    if (options.confined) {
        std::vector<std::filesystem::path> folders = options.allowed_folders;
        folders.push_back(std::filesystem::path(path).parent_path());
        finder.confine(folders);
    }
    const Document document =
        in_phase(options.phases, phase_names::parse, [&] { return read_document(path, options, finder, diagnostics); });
    LoadedScene loaded;
    const Phase phase(options.phases, phase_names::build);
    loaded.scene = SceneBuilder(document, options, finder, diagnostics).build();
    diagnostics.throw_if_errors();
    loaded.scene.path = path;
    loaded.warnings = diagnostics.warnings();
    loaded.files.assign(finder.found().begin(), finder.found().end());
    loaded.files.insert(loaded.files.begin(), path);
    return loaded;
}

} // namespace gradus
