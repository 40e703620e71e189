#include "runtime/io/spectrum_file.h"

#include "runtime/io/text.h"

#include <string_view>

namespace gradus {

std::optional<std::string> spectrum_of_file(const std::string &text) {
    std::string pairs;
    for (std::string_view rest = std::string_view(text).substr(byte_order_mark(text).size()); !rest.empty();) {
        const std::string_view line = take_line(rest);
        const std::string content(trimmed(line.substr(0, line.find('#'))));
        if (content.empty())
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
