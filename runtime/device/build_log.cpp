#include "runtime/device/build_log.h"

#include <fmt/format.h>

#include <charconv>
#include <sstream>
#include <string_view>
#include <vector>

namespace gradus {

namespace {

constexpr std::string_view whole_source = "<kernel>:";

/// Where each line of the source is from, as "file:line"; its first line is the first.
std::vector<std::string> places_of_lines(const std::string &source) {
    constexpr std::string_view directive = "#line ";
    std::vector<std::string> places;
    std::istringstream lines(source);
    std::string line, file(whole_source.substr(0, whole_source.size() - 1));
    int number = 1;
    while (std::getline(lines, line)) {
        places.push_back(fmt::format("{}:{}", file, number++));
        if (!line.starts_with(directive))
            continue;
        std::from_chars(line.data() + directive.size(), line.data() + line.size(), number);
        if (const std::size_t open = line.find('"'), close = line.rfind('"'); open < close)
            file = line.substr(open + 1, close - open - 1);
    }
    return places;
}

} // namespace

std::string with_file_names(const std::string &log, const std::string &source) {
    if (log.find(whole_source) == std::string::npos)
        return log;
    const std::vector<std::string> places = places_of_lines(source);
    std::string named;
    for (std::size_t at = 0;;) {
        const std::size_t found = log.find(whole_source, at);
        named += log.substr(at, found - at);
        if (found == std::string::npos)
            return named;
        std::size_t number = 0;
        const char *const digits = log.data() + found + whole_source.size();
        const char *const end = std::from_chars(digits, log.data() + log.size(), number).ptr;
        const bool is_known = number >= 1 && number <= places.size();
        at = is_known ? std::size_t(end - log.data()) : found + whole_source.size();
        named += is_known ? places[number - 1] : std::string(whole_source);
    }
}

bool tells_of_error(const std::string &log) { return log.find("error:") != std::string::npos; }

std::string with_hint_at_folder(const std::string &log, const std::string &pocl_folder) {
    if (tells_of_error(log))
        return log;
    return fmt::format("{}{}no error in the source is told: is {} full, or not to be written to?", log,
                       log.empty() || log.back() == '\n' ? "" : "\n",
                       pocl_folder.empty() ? "PoCL's folder (POCL_CACHE_DIR)" : fmt::format("'{}'", pocl_folder));
}

} // namespace gradus
