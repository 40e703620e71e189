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

/// What the choice among lights goes by.
struct LightPower {
    double power = 0;          ///< watts (or what a light at infinity sends through a disk as wide as the scene)
    std::uint32_t emitter = 0; ///< the emitter that it is a part of: a mesh has a light for each triangle
    bool at_infinity = false;
};

/// Weights by which the lights of a scene are chosen: by power, with half of the choice shared out equally among the
/// emitters, so that a dim lamp next to what it lights is not starved. The power of a light at infinity grows with the
/// scene and says nothing of what reaches a point, so such a one counts as the mean of the others, if there are any.
std::vector<double> light_weights(const std::vector<LightPower> &lights);

} // namespace gradus
