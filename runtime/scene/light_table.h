// The lights of a scene with the probabilities by which they are chosen.
#pragma once

#include <cstdint>
#include <vector>

namespace gradus {

/// An alias table (Vose 1991): draw a column uniformly, keep it where a second draw is below its threshold, else take
/// its alias.
struct AliasTable {
    std::vector<float> probability; ///< of each entry, adding up to 1
    std::vector<float> threshold;
    std::vector<std::uint32_t> alias;
};

/// Weights must not be negative, and one at least must be positive.
AliasTable make_alias_table(const std::vector<double> &weights);

} // namespace gradus
