#include "runtime/io/file_search.h"

#include "runtime/io/text.h"

#include <algorithm>
#include <fstream>

namespace gradus {
namespace fs = std::filesystem;

namespace {

/// Follows `relative` from `folder`, at each step taking the entry of that name or, failing that, the first in
/// alphabetical order that differs in case alone.
std::optional<fs::path> follow_ignoring_case(fs::path folder, const fs::path &relative) {
    std::error_code error;
    for (const fs::path &part : relative) {
        if (part == "." || part == ".." || fs::exists(folder / part, error)) {
            folder /= part;
            continue;
        }
        const std::string wanted = lower_case(part.string());
        std::vector<fs::path> matches;
        for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
            if (lower_case(entry->path().filename().string()) == wanted)
                matches.push_back(entry->path());
        if (matches.empty())
            return std::nullopt;
        folder = *std::min_element(matches.begin(), matches.end());
    }
    if (!fs::is_regular_file(folder, error))
        return std::nullopt;
    return folder;
}

} // namespace

std::optional<FoundFile> find_file(const std::string &name, const std::vector<fs::path> &folders) {
    std::string slashed(trimmed(name));
    std::replace(slashed.begin(), slashed.end(), '\\', '/');
    if (slashed.empty() || slashed.find('\0') != std::string::npos)
        return std::nullopt;
    const fs::path path(slashed);
    const std::vector<fs::path> starts = path.is_absolute() ? std::vector<fs::path>{path.root_path()} : folders;
    const fs::path relative = path.relative_path();
    std::error_code error;
    for (const fs::path &start : starts)
        if (fs::is_regular_file(start / relative, error))
            return FoundFile{start / relative, true};
    for (const fs::path &start : starts)
        if (const auto found = follow_ignoring_case(start.empty() ? fs::path(".") : start, relative))
            return FoundFile{*found, false};
    return std::nullopt;
}

std::optional<std::string> read_whole_file(const fs::path &path) {
    std::error_code error;
    if (!fs::is_regular_file(path, error))
        return std::nullopt;
    std::ifstream stream(path, std::ios::binary);
    const std::uintmax_t size = fs::file_size(path, error);
    if (!stream || error)
        return std::nullopt;
    std::string text(size, '\0');
    stream.read(text.data(), std::streamsize(size));
    if (std::uintmax_t(stream.gcount()) != size)
        return std::nullopt;
    return text;
}

} // namespace gradus
