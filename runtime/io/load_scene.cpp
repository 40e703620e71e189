#include "runtime/io/load_scene.h"

#include "runtime/io/diagnostics.h"
#include "runtime/io/document.h"
#include "runtime/io/scene_builder.h"

namespace gradus {

LoadedScene load_scene(const std::string &path, const LoadOptions &options) {
    Diagnostics diagnostics(options.strict);
    const Document document = read_document(path, options.parameters, diagnostics);
    LoadedScene loaded;
    loaded.scene = SceneBuilder(document, diagnostics).build();
    diagnostics.throw_if_errors();
    loaded.scene.path = path;
    loaded.warnings = diagnostics.warnings();
    return loaded;
}

} // namespace gradus
