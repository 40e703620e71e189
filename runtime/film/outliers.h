// Images that stand for the reference that there is not: what a pixel is weighed by must not be its own outlier.
#pragma once

#include <cstdint>
#include <vector>

namespace gradus {

/// Each value of a plane, but no more than the second largest and no less than the second smallest of the eight around
/// it. Beyond an edge is what is nearest within, but not the pixel itself.
std::vector<double> without_outliers(const std::vector<double> &plane, std::uint32_t width, std::uint32_t height);

/// What relMSE (metrics.h) weighs pixels by, this plane without its outliers being the reference. What is not finite
/// counts as 0.
std::vector<double> relative_weights(std::vector<double> plane, std::uint32_t width, std::uint32_t height);

} // namespace gradus
