// Finds the files that a scene names, as forgiving as its users need.
#pragma once

#include "runtime/io/open_file.h"

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace gradus {

struct FoundFile {
    std::filesystem::path path;
    bool exact = true; ///< false: only found by ignoring case
};

class FileFinder {
  public:
    /// From now on files outside of these folders are not found, whether or not they exist. An empty path is the
    /// working folder. Throws Error(ExitCode::scene) for a folder that is not there.
    void confine(const std::vector<std::filesystem::path> &folders);
    bool is_confined() const { return !allowed_.empty(); }

    /// Looks for `name` (absolute, or relative to one of the folders in order). Backslashes count as slashes. Where no
    /// file has that very name, letters are compared without case.
    std::optional<FoundFile> find(const std::string &name, const std::vector<std::filesystem::path> &folders);

    /// Opens what was found, or nullptr: what may not be read by now is not, whatever it was when it was found. Any
    /// thread may ask.
    std::shared_ptr<const OpenFile> open(const std::filesystem::path &path) const;

    /// All that were found so far, each once.
    const std::set<std::string> &found() const { return found_; }

    /// Why find() finds nothing, for messages: "", or what there is to add to "cannot find the file".
    std::string why_not(const std::string &name, const std::vector<std::filesystem::path> &folders) const;

  private:
    std::optional<FoundFile> search(const std::string &name, const std::vector<std::filesystem::path> &folders);
    /// place: where links lead.
    bool is_allowed(const std::filesystem::path &place) const;
    bool is_allowed(const Place &place) const;
    std::optional<std::filesystem::path> follow_ignoring_case(std::filesystem::path folder,
                                                              const std::filesystem::path &relative);
    const std::map<std::string, std::string> &listing(const std::filesystem::path &folder);

    std::vector<std::filesystem::path> allowed_; ///< canonical; empty: all
    std::set<std::string> found_;
    /// By folder: its entries by their names in lower case; of several the first in alphabetical order.
    std::map<std::string, std::map<std::string, std::string>> listings_;
};

} // namespace gradus
