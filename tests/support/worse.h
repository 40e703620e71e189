// The worst of many numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace gradus::testing {

/// The larger of both; infinity where `value` is no number, which std::max would pass over.
inline double worse(double worst, double value) {
    return std::isnan(value) ? std::numeric_limits<double>::infinity() : std::max(worst, value);
}

} // namespace gradus::testing
