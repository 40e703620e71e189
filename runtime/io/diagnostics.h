// What goes wrong while a scene is read: warnings that are kept, errors that are collected so that a user sees all of
// them at once.
#pragma once

#include "runtime/io/location.h"

#include <cstddef>
#include <stdexcept>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

namespace gradus {

/// "file:line: message", long messages cut in their middle.
std::string located(const Location &location, const std::string &message);

/// An error in one object of a scene. The loader catches it at the object, goes on with the next one and reports all
/// of them together.
class SceneError : public std::runtime_error {
  public:
    SceneError(const Location &location, const std::string &message, std::string cause = {})
        : std::runtime_error(located(location, message)), cause(std::move(cause)) {}
    /// Of a file that the scene names: the same error, which says where. Once for all places that name it.
    SceneError named_at(const Location &location) const;

    /// What is at fault where many places may say so: nobody needs to hear of it again. Empty: the place itself.
    std::string cause = {};

  private:
    explicit SceneError(const std::string &text) : std::runtime_error(text) {}
};

class Diagnostics {
  public:
    explicit Diagnostics(bool strict) : strict_(strict) {}

    /// Only the first hundred are kept: a scene by a program may have one for each of a million elements.
    void warn(const Location &location, const std::string &message);
    /// Something that the file says and nobody reads: a warning, or an error where the user asked for strictness.
    void unknown(const Location &location, const std::string &message);
    /// Throws like throw_if_errors() at the hundredth: what is wrong there has been said.
    void error(const Location &location, const std::string &message);
    void error(const SceneError &error);

    /// From now on reports are kept aside, until release() hands them out: for work that is done out of order.
    struct Held {
        enum class Kind { warning, unknown, error } kind;
        Location location;
        std::string message;
    };
    void hold() { is_holding_ = true; }
    std::vector<Held> release();
    /// Reports them as if they came now.
    void replay(const std::vector<Held> &messages);

    /// Throws Error with ExitCode::scene and every message so far, one a line, if there is an error.
    void throw_if_errors() const;
    /// Those kept, and how many were not.
    std::vector<std::string> warnings() const;
    bool has_errors() const { return !errors_.empty(); }
    /// Further warnings are only counted: what would take long to find out for them may be left out.
    bool is_full() const;

  private:
    void add_error(const std::string &text);

    bool strict_, is_holding_ = false;
    std::vector<Held> held_;
    std::vector<std::string> warnings_, errors_;
    std::unordered_set<std::string> known_;  ///< both, for repetitions
    std::unordered_set<std::string> causes_; ///< that were told
    std::size_t warnings_left_out_ = 0, error_reports_ = 0;
};

} // namespace gradus
