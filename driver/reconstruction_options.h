// Options that `gradus solve` and the gradient-domain methods of `gradus render` share.
#pragma once

#include "solver/reconstruction.h"

#include <functional>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace gradus {

/// The number that the whole text is, or nothing; NaN and infinity are none.
std::optional<double> finite_number(const std::string &text);

/// A complaint about a text that is not a number above 0, or nothing: a check for CLI11.
std::string complain_unless_positive(std::string &text);

/// --reconstruction l1|l2|weighted|guided, and --norm, the old name of the first two. `standard` is the default to
/// print.
void add_reconstruction_option(CLI::App &command, const char *group, Reconstruction standard,
                               std::function<void(Reconstruction)> set);

/// --guide filter|denoiser.
void add_guide_option(CLI::App &command, const char *group, std::function<void(Guide)> set);

/// Throws Error(ExitCode::usage) where a weight of the primal is `given` to a reconstruction that has many.
void check_alpha(Reconstruction reconstruction, bool given);

/// --alpha NUMBER|auto, a number from 0 on; `set` gets nothing for auto. `standard` is the default to print.
void add_alpha_option(CLI::App &command, const char *group, const char *standard, const char *text,
                      std::function<void(std::optional<double>)> set);

} // namespace gradus
