#include "runtime/io/file_search.h"

#include "runtime/error.h"
#include "runtime/io/text.h"

#include <algorithm>

namespace gradus {
namespace fs = std::filesystem;

namespace {

struct Places {
    fs::path relative;
    std::vector<fs::path> starts; ///< from which it leads to where a file may be; none: no file is called so
};

Places places_of(const std::string &name, const std::vector<fs::path> &folders) {
    constexpr std::size_t longest = 4096; // no system opens longer ones
    std::string slashed(trimmed(name));
    std::replace(slashed.begin(), slashed.end(), '\\', '/');
    if (slashed.empty() || slashed.size() > longest || slashed.find('\0') != std::string::npos)
        return {};
    const fs::path path(slashed);
    return {path.relative_path(), path.is_absolute() ? std::vector<fs::path>{path.root_path()} : folders};
}

} // namespace

void FileFinder::confine(const std::vector<fs::path> &folders) {
    for (const fs::path &folder : folders) {
        std::error_code error;
        const fs::path canonical = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
        if (error || !fs::is_directory(canonical, error))
            throw Error(ExitCode::scene, "--confined: there is no folder \"" + folder.string() + "\"");
        allowed_.push_back(canonical);
    }
}

bool FileFinder::is_allowed(const fs::path &place) const {
    return std::any_of(allowed_.begin(), allowed_.end(), [&](const fs::path &folder) {
        return std::mismatch(folder.begin(), folder.end(), place.begin(), place.end()).first == folder.end();
    });
}

bool FileFinder::is_allowed(const Place &place) const { return !is_confined() || is_allowed(place.path()); }

std::shared_ptr<const OpenFile> FileFinder::open(const fs::path &path) const {
    return is_confined() ? OpenFile::open(path, [this](const fs::path &place) { return is_allowed(place); })
                         : OpenFile::open(path);
}

/// A folder is listed once: a scene may have a thousand names in the wrong case.
const std::map<std::string, std::string> &FileFinder::listing(const fs::path &folder) {
    const auto [at, is_new] = listings_.try_emplace(folder.string());
    const Place place(folder);
    if (!is_new || !place.is_folder() || !is_allowed(place))
        return at->second;
    std::error_code error;
    const fs::path listed = is_confined() ? fs::path(place.alias()) : folder;
    for (fs::directory_iterator entry(listed, error), end; !error && entry != end; entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        const auto [first, is_first] = at->second.try_emplace(lower_case(name), name);
        if (!is_first)
            first->second = std::min(first->second, name);
    }
    return at->second;
}

/// Follows `relative` from `folder`, at each step taking the entry of that name or, failing that, the first in
/// alphabetical order that differs in case alone.
std::optional<fs::path> FileFinder::follow_ignoring_case(fs::path folder, const fs::path &relative) {
    std::error_code error;
    for (const fs::path &part : relative) {
        if (part == "." || part == ".." || fs::exists(folder / part, error)) {
            folder /= part;
            continue;
        }
        const auto &entries = listing(folder);
        const auto match = entries.find(lower_case(part.string()));
        if (match == entries.end())
            return std::nullopt;
        folder /= match->second;
    }
    if (!fs::is_regular_file(folder, error))
        return std::nullopt;
    return folder;
}

std::optional<FoundFile> FileFinder::find(const std::string &name, const std::vector<fs::path> &folders) {
    std::optional<FoundFile> file = search(name, folders);
    if (file)
        found_.insert(file->path.string());
    return file;
}

std::string FileFinder::why_not(const std::string &name, const std::vector<fs::path> &folders) const {
    if (is_confined()) // of what is outside nothing is told
        return " in the folders that --confined leaves";
    std::error_code error;
    const auto [relative, starts] = places_of(name, folders);
    for (const fs::path &start : starts)
        if (const fs::path there = start / relative; fs::exists(there, error))
            return fs::is_directory(there, error) ? ": it is a folder" : ": it is not a regular file";
    return "";
}

std::optional<FoundFile> FileFinder::search(const std::string &name, const std::vector<fs::path> &folders) {
    std::error_code error;
    const auto [relative, starts] = places_of(name, folders);
    for (const fs::path &start : starts)
        if (fs::is_regular_file(start / relative, error) && is_allowed(Place(start / relative)))
            return FoundFile{start / relative, true};
    for (const fs::path &start : starts)
        if (const auto found = follow_ignoring_case(start.empty() ? fs::path(".") : start, relative);
            found && is_allowed(Place(*found)))
            return FoundFile{*found, false};
    return std::nullopt;
}

} // namespace gradus
