// Finds the files that a scene names, as forgiving as its users need.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gradus {

struct FoundFile {
    std::filesystem::path path;
    bool exact = true; ///< false: only found by ignoring case
};

/// Looks for `name` (absolute, or relative to one of the folders in order). Backslashes count as slashes. Where no
/// file has that very name, letters are compared without case.
std::optional<FoundFile> find_file(const std::string &name, const std::vector<std::filesystem::path> &folders);

/// The whole file, or nothing if it cannot be read or is no regular file.
std::optional<std::string> read_whole_file(const std::filesystem::path &path);

} // namespace gradus
