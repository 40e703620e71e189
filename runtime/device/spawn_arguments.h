// What posix_spawn() and the exec functions take: the arguments and the environment of a program.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <unistd.h>

namespace gradus {

/// The environment of this process with these variables, name and value, in the place of those it has.
inline std::vector<std::string> environment_with(const std::vector<std::pair<std::string, std::string>> &changes) {
    std::vector<std::string> variables;
    for (char **variable = environ; variable && *variable; ++variable)
        if (std::none_of(changes.begin(), changes.end(), [&](const auto &change) {
                return std::string_view(*variable).starts_with(change.first + '=');
            }))
            variables.emplace_back(*variable);
    for (const auto &[name, value] : changes)
        variables.push_back(name + '=' + value);
    return variables;
}

/// With a null pointer at the end. They hold as long as the texts do.
inline std::vector<char *> pointers_to(std::vector<std::string> &texts) {
    std::vector<char *> pointers;
    for (std::string &text : texts)
        pointers.push_back(text.data());
    pointers.push_back(nullptr);
    return pointers;
}

} // namespace gradus
