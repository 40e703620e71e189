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

/// --reconstruction l1|l2|weighted|guided, and --norm, the old name of the first two. `standard` is the default to
/// print.
void add_reconstruction_option(CLI::App &command, const char *group, Reconstruction standard,
                               std::function<void(Reconstruction)> set);

/// --guide filter|denoiser.
void add_guide_option(CLI::App &command, const char *group, std::function<void(Guide)> set);

/// Throws Error(ExitCode::usage) where a weight of the primal is `given` to a reconstruction that has many, or one
/// that is too small for it.
void check_alpha(Reconstruction reconstruction, bool given, double alpha);

/// --alpha NUMBER|auto, a number from 0 on; `set` gets nothing for auto. `standard` is the default to print.
void add_alpha_option(CLI::App &command, const char *group, const char *standard, const char *text,
                      std::function<void(std::optional<double>)> set);

} // namespace gradus
