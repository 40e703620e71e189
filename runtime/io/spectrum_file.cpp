#include "runtime/io/spectrum_file.h"

#include "runtime/io/text.h"

#include <sstream>

namespace gradus {

std::optional<std::string> spectrum_of_file(const std::string &text) {
    std::istringstream lines(text);
    std::string pairs;
    for (std::string line; std::getline(lines, line);) {
        const std::string content(trimmed(line));
        if (content.empty() || content.front() == '#')
            continue;
        const auto items = split_list(content);
        if (items.size() != 2 || !parse_number(items[0]) || !parse_number(items[1]))
            return std::nullopt;
        pairs += (pairs.empty() ? "" : ", ") + std::string(items[0]) + ":" + std::string(items[1]);
    }
    if (pairs.empty())
        return std::nullopt;
    return pairs;
}

} // namespace gradus
