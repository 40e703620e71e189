#include "runtime/io/diagnostics.h"

#include "runtime/error.h"
#include "runtime/io/text.h"

#include <utility>

namespace gradus {

namespace {
// As many as a user reads. Reports that repeat what was said count too, for finding each may have taken long.
constexpr std::size_t most_messages = 100, most_error_reports = 1000;
constexpr std::size_t longest_message = 2000;
} // namespace

std::string located(const Location &location, const std::string &message) {
    return location.text() + ": " + shortened(message, longest_message);
}

SceneError SceneError::named_at(const Location &location) const {
    SceneError error(std::string(what()) + "; the file is named at " + location.text());
    error.cause = cause.empty() ? what() : cause;
    return error;
}

bool Diagnostics::is_full() const { return warnings_.size() >= most_messages; }

void Diagnostics::warn(const Location &location, const std::string &message) {
    if (is_holding_) {
        held_.push_back({Held::Kind::warning, location, message});
        return;
    }
    if (is_full()) {
        ++warnings_left_out_;
        return;
    }
    const std::string text = located(location, message);
    if (known_.insert(text).second)
        warnings_.push_back(text);
}

void Diagnostics::unknown(const Location &location, const std::string &message) {
    if (is_holding_)
        held_.push_back({Held::Kind::unknown, location, message});
    else if (strict_)
        error(location, message);
    else
        warn(location, message);
}

void Diagnostics::error(const Location &location, const std::string &message) {
    if (is_holding_)
        held_.push_back({Held::Kind::error, location, message});
    else
        add_error(located(location, message));
}

std::vector<Diagnostics::Held> Diagnostics::release() {
    is_holding_ = false;
    return std::exchange(held_, {});
}

void Diagnostics::replay(const std::vector<Held> &messages) {
    for (const auto &[kind, location, message] : messages)
        if (kind == Held::Kind::warning)
            warn(location, message);
        else if (kind == Held::Kind::unknown)
            unknown(location, message);
        else
            error(location, message);
}

void Diagnostics::error(const SceneError &error) {
    if (error.cause.empty() || causes_.insert(error.cause).second)
        add_error(error.what());
}

void Diagnostics::add_error(const std::string &text) {
    if (known_.insert("error " + text).second)
        errors_.push_back(text);
    if (++error_reports_ < most_error_reports && errors_.size() < most_messages)
        return;
    errors_.push_back("too many errors: what comes after is not read");
    throw_if_errors();
}

std::vector<std::string> Diagnostics::warnings() const {
    std::vector<std::string> all = warnings_;
    if (warnings_left_out_ > 0)
        all.push_back("and " + std::to_string(warnings_left_out_) + " more warnings");
    return all;
}

void Diagnostics::throw_if_errors() const {
    if (errors_.empty())
        return;
    std::string text;
    for (const std::string &error : errors_)
        text += (text.empty() ? "" : "\n") + error;
    throw Error(ExitCode::scene, text);
}

} // namespace gradus
