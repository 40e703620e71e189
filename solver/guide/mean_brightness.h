// How bright an image is that guides are judged or corrected by.
#pragma once

#include "runtime/device/buffer.h"

#include <cmath>
#include <cstddef>

namespace gradus {

/// The mean absolute value of the first `values` floats of an image; what is NaN or infinite counts as 0.
inline double mean_brightness(const Buffer &image, std::size_t values) {
    const Buffer::Mapping mapping(image, Access::read, Wait::now);
    const float *value = mapping.as<float>();
    double sum = 0;
    for (std::size_t i = 0; i < values; ++i)
        sum += std::isfinite(value[i]) ? std::abs(double(value[i])) : 0;
    return sum / double(values);
}

} // namespace gradus
