// What the solver's main kernels move.
#pragma once

#include <optional>
#include <string>

namespace gradus::bench {

/// How many values an item of this kernel has to read and write, with uniform weights, or a pixel where it works tile by
/// tile; nothing for a kernel that is not one of the main ones. A neighbour's value in a stencil comes from the cache and
/// is not counted.
std::optional<double> solver_traffic(const std::string &kernel);

} // namespace gradus::bench
