// Where in which file something was written, for messages.
#pragma once

#include <memory>
#include <string>

namespace gradus {

struct Location {
    std::shared_ptr<const std::string> file; ///< path as the user knows it
    std::size_t line = 0;                    ///< from 1; 0: the file as a whole

    /// "file:line", or "file" where the line is not known.
    std::string text() const {
        if (!file)
            return "scene";
        return line == 0 ? *file : *file + ":" + std::to_string(line);
    }
};

} // namespace gradus
