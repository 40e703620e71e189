// Reads a Mitsuba scene file (versions 0.4 to 3) with all that it names into a Scene. docs/scene-format.md says what
// is understood.
#pragma once

#include "runtime/scene/scene.h"

#include <map>
#include <string>
#include <vector>

namespace gradus {

struct LoadOptions {
    std::map<std::string, std::string> parameters; ///< -D name=value, before the file's own <default>s
    bool strict = false;                           ///< parameters that are not known become errors
};

struct LoadedScene {
    Scene scene;                       ///< in world space
    std::vector<std::string> warnings; ///< "file:line: text", in the order in which they were met
};

/// Throws Error (ExitCode::scene) with one "file:line: text" a line for everything that is wrong, so far as it can be
/// found out in one go: all missing files are listed together.
LoadedScene load_scene(const std::string &path, const LoadOptions &options = {});

} // namespace gradus
