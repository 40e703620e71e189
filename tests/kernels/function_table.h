// The functions of kernels/lib in one precision, called with doubles: lets one program hold both builds.
#pragma once

#include <array>
#include <span>

namespace gradus::testing {

struct Arguments {
    std::array<double, 18> material; ///< the fields of GRADUS_MATERIAL_FIELDS in their order
    std::array<double, 3> wi, wo;    ///< unit vectors
    double u_lobe, u1, u2;
};

struct Results {
    std::array<double, 3> eval;
    double pdf, pdf_reverse;
    std::array<double, 3> wo, weight; ///< of the sample
    double sample_pdf, eta;
};

struct FunctionEntry {
    const char *name;
    bool is_delta;
    Results (*call)(const Arguments &);
};

std::span<const FunctionEntry> float_functions();
std::span<const FunctionEntry> double_functions();

} // namespace gradus::testing
