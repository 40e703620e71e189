// Between the vectors of the build that is tested and those in long double, and what its roundings are.
#pragma once

#include "tests/kernels/long_direction.h"
#include "tests/kernels/precision.h"

#include <cmath>
#include <limits>

namespace gradus::testing {

constexpr double epsilon = std::numeric_limits<real>::epsilon();

inline lib::vec3 as_real(LongVector v) { return lib::v3(real(v.x), real(v.y), real(v.z)); }
inline LongVector as_long(lib::vec3 v) { return {v.x, v.y, v.z}; }

inline double distance(LongVector a, LongVector b) { return double(length(a - b)); }
inline double distance(lib::vec3 a, lib::vec3 b) {
    return std::sqrt(double(lib::v3_length_squared(lib::v3_sub(a, b))));
}

} // namespace gradus::testing
