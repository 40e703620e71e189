// How many of a number of rays each pixel gets.
#pragma once

#include <cstdint>
#include <vector>

namespace gradus {

/// Shares `rays` in proportion to `needs`, which are positive: no pixel gets more than `most`, and what it leaves goes
/// to others; those of the least need, which would get less than `least`, get none. By pixel.
std::vector<std::uint32_t> shared_rays(const std::vector<float> &needs, double rays, std::uint32_t least,
                                       std::uint32_t most);

} // namespace gradus
