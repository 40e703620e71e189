// stdout and stderr. What a command prints is its result: that it cannot be written is an error. What it says on
// stderr is not: a full disk under a log must not end a render.
#pragma once

#include <string>

namespace gradus {

/// Writes to stdout and flushes. Throws Error(ExitCode::output).
void print_result(const std::string &text);

/// Writes to stderr as far as that goes. Throws nothing.
void print_message(const std::string &text);

} // namespace gradus
