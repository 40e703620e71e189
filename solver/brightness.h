// Images too bright or too dark for single precision: reconstructions take squares of their values and weigh them by
// variances, so by squares again.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>

namespace gradus {

/// Of a mean of absolute values. Below it an image differs by more than 1e-5 from that of the same inputs, brighter: by
/// 3e-3 at 1e-16. Above it pixels a hundred times as bright have no square.
constexpr double darkest_mean = 1e-12, brightest_mean = 1e17;

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
    if (mean == 0 || (mean >= darkest_mean && mean <= brightest_mean))
        return "";
    return fmt::format("the image's mean is {:.3g}, and reconstructions square values, for which single precision has "
                       "room from {:g} to {:g}: make the lights brighter or darker",
                       mean, darkest_mean, brightest_mean);
}

} // namespace gradus
