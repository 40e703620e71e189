// Options that `gradus solve` and the gradient-domain methods of `gradus render` share.
#pragma once

#include "solver/poisson_solver.h"

#include <functional>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace gradus {

/// The number that the whole text is, or nothing; NaN and infinity are none.
std::optional<double> finite_number(const std::string &text);

/// --norm L1|L2.
void add_norm_option(CLI::App &command, const char *group, std::function<void(PoissonNorm)> set);

/// --alpha NUMBER|auto, a number from 0 on; `set` gets nothing for auto. `standard` is the default to print.
void add_alpha_option(CLI::App &command, const char *group, const char *standard, const char *text,
                      std::function<void(std::optional<double>)> set);

} // namespace gradus
