// How a scene file is to be read.
#pragma once

#include "runtime/io/limits.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace gradus {

class Phases;

/// What becomes of instances of groups of shapes: shapes of their own, which are faster to trace, or instances, which
/// take no memory for geometry. Automatic: copies where all of them are small, or a group has but one.
enum class InstanceChoice { automatic, copies, kept };
struct LoadOptions {
    std::map<std::string, std::string> parameters; ///< -D name=value, before the file's own <default>s
    bool strict = false;                           ///< parameters that are not known become errors
    /// Refuse files that do not lie in the scene's folder or in one of allowed_folders, links resolved: for scenes by
    /// strangers.
    bool confined = false;
    std::vector<std::filesystem::path> allowed_folders = {};
    LoadLimits limits = {};
    Phases *phases = nullptr; ///< where the time is counted; may be nullptr
    InstanceChoice instances = InstanceChoice::automatic;
    /// Automatic: of copies of groups that are seen more than once, in bytes of their meshes, before all are kept as
    /// instances.
    std::uint64_t most_copied_bytes = 32u << 20;
    bool ignore_media = false; ///< scenes with participating media as if these were empty; else they are errors
};

} // namespace gradus
