// Images too bright or too dark for single precision: reconstructions take squares of their values and weigh them by
// variances, so by squares again.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>

namespace gradus {

/// Of a mean of absolute values. Below it an image differs by more than 1e-5 from that of the same inputs, brighter: by
/// 3e-3 at 1e-16.
constexpr double darkest_mean = 1e-12;

/// Above it pixels a hundred times as bright have no square, or the squares of all values no sum: of ten times as much
/// 1280 x 720 pixels stayed as noisy as they were.
inline double brightest_mean(std::size_t values) {
    return std::min(1e17, 6e18 / std::sqrt(double(std::max<std::size_t>(values, 1))));
}

/// What there is to say of an image of these channels; empty where its mean is within the bounds, or 0. What is no
/// number does not count.
inline std::string note_of_brightness(std::initializer_list<std::span<const float>> channels) {
    double sum = 0;
    std::size_t count = 0;
    for (const std::span<const float> channel : channels)
        for (const float value : channel)
            if (std::isfinite(value)) {
                sum += std::abs(double(value));
                ++count;
            }
    const double mean = count > 0 ? sum / double(count) : 0;
    const double brightest = brightest_mean(count);
    if (mean == 0 || (mean >= darkest_mean && mean <= brightest))
        return "";
    return fmt::format("the image's mean is {:.3g}, and reconstructions square values, for which single precision has "
                       "room from {:g} to {:.2g}: make the lights brighter or darker",
                       mean, darkest_mean, brightest);
}

} // namespace gradus
