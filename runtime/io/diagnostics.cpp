#include "runtime/io/diagnostics.h"

#include "runtime/error.h"

#include <algorithm>

namespace gradus {

namespace {
// More than a user reads; a broken file of a thousand meshes need not print a thousand lines.
constexpr std::size_t most_messages = 100;

bool contains(const std::vector<std::string> &list, const std::string &text) {
    return std::find(list.begin(), list.end(), text) != list.end();
}
} // namespace

void Diagnostics::warn(const Location &location, const std::string &message) {
    const std::string text = location.text() + ": " + message;
    if (!contains(warnings_, text))
        warnings_.push_back(text);
}

void Diagnostics::unknown(const Location &location, const std::string &message) {
    if (strict_)
        error(location, message);
    else
        warn(location, message);
}

void Diagnostics::error(const Location &location, const std::string &message) {
    add_error(location.text() + ": " + message);
}

void Diagnostics::error(const SceneError &error) { add_error(error.what()); }

void Diagnostics::add_error(const std::string &text) {
    if (!contains(errors_, text))
        errors_.push_back(text);
}

void Diagnostics::throw_if_errors() const {
    if (errors_.empty())
        return;
    std::string text;
    const std::size_t shown = std::min(errors_.size(), most_messages);
    for (std::size_t i = 0; i < shown; ++i)
        text += (i ? "\n" : "") + errors_[i];
    if (shown < errors_.size())
        text += "\nand " + std::to_string(errors_.size() - shown) + " more errors";
    throw Error(ExitCode::scene, text);
}

} // namespace gradus
