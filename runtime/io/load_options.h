// How a scene file is to be read.
#pragma once

#include "runtime/io/limits.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace gradus {

class Phases;

struct LoadOptions {
    std::map<std::string, std::string> parameters; ///< -D name=value, before the file's own <default>s
    bool strict = false;                           ///< parameters that are not known become errors
    /// Refuse files that do not lie in the scene's folder or in one of allowed_folders, links resolved: for scenes by
    /// strangers.
    bool confined = false;
    std::vector<std::filesystem::path> allowed_folders = {};
    LoadLimits limits = {};
    Phases *phases = nullptr;  ///< where the time is counted; may be nullptr
    bool ignore_media = false; ///< scenes with participating media as if these were empty; else they are errors
};

} // namespace gradus
