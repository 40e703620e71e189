// The shifts of kernels/lib in both precisions, called with doubles: lets one program hold both builds.
#pragma once

#include <array>

namespace gradus::testing {

struct ReconnectionArguments {
    std::array<double, 3> base, offset, target, normal;
};

struct HalfVectorArguments {
    std::array<double, 3> wi_base, wo_base, wi_offset;
    double ior_base, ior_offset;
};

struct ShiftResult {
    std::array<double, 3> wo;
    double jacobian;
    bool is_valid;
};

struct ShiftFunctions {
    double (*reconnection)(const ReconnectionArguments &);
    ShiftResult (*half_vector)(const HalfVectorArguments &);
    ShiftResult (*specular)(const HalfVectorArguments &); ///< does not read ior_base
};

extern const ShiftFunctions shifts_in_float, shifts_in_double;

} // namespace gradus::testing
