// Reads a Mitsuba scene file (versions 0.4 to 3) with all that it names into a Scene. docs/scene-format.md says what
// is understood.
#pragma once

#include "runtime/io/load_options.h"
#include "runtime/scene/scene.h"

#include <string>
#include <vector>

namespace gradus {

struct LoadedScene {
    Scene scene;                       ///< in world space
    std::vector<std::string> warnings; ///< "file:line: text", in the order in which they were met
    std::vector<std::string> files;    ///< all that were read, the scene file first
};

/// Throws Error (ExitCode::scene) with one "file:line: text" a line for everything that is wrong, so far as it can be
/// found out in one go: all missing files are listed together.
LoadedScene load_scene(const std::string &path, const LoadOptions &options = {});

} // namespace gradus
