// What goes wrong while a scene is read: warnings that are kept, errors that are collected so that a user sees all of
// them at once.
#pragma once

#include "runtime/io/location.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace gradus {

/// An error in one object of a scene. The loader catches it at the object, goes on with the next one and reports all
/// of them together.
class SceneError : public std::runtime_error {
  public:
    SceneError(const Location &location, const std::string &message)
        : std::runtime_error(location.text() + ": " + message) {}
};

class Diagnostics {
  public:
    explicit Diagnostics(bool strict) : strict_(strict) {}

    void warn(const Location &location, const std::string &message);
    /// Something that the file says and nobody reads: a warning, or an error where the user asked for strictness.
    void unknown(const Location &location, const std::string &message);
    void error(const Location &location, const std::string &message);
    void error(const SceneError &error);

    /// Throws Error with ExitCode::scene and every message so far, one a line, if there is an error.
    void throw_if_errors() const;
    const std::vector<std::string> &warnings() const { return warnings_; }
    bool has_errors() const { return !errors_.empty(); }

  private:
    void add_error(const std::string &text);

    bool strict_;
    std::vector<std::string> warnings_, errors_;
};

} // namespace gradus
