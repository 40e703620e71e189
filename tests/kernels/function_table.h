// The functions of kernels/lib in one precision, called with doubles: lets one program hold both builds.
#pragma once

#include "kernels/shared/bsdf_list.h"

#include <array>
#include <cstddef>
#include <span>

namespace gradus::testing {

/// The fields of GRADUS_MATERIAL_FIELDS.
#define GRADUS_FIELD_NAME(name) name,
enum class Field { GRADUS_MATERIAL_FIELDS(GRADUS_FIELD_NAME) count };
#undef GRADUS_FIELD_NAME
constexpr auto material_fields = std::size_t(Field::count);

struct Arguments {
    std::array<double, material_fields> material; ///< in their order
    double &operator[](Field field) { return material[std::size_t(field)]; }
    double operator[](Field field) const { return material[std::size_t(field)]; }
    std::array<double, 3> wi, wo; ///< unit vectors
    double u_lobe, u1, u2;
};

struct Evaluated {
    std::array<double, 3> value;
    double pdf, pdf_reverse;
};

struct Sampled {
    std::array<double, 3> wo, weight;
    double pdf, eta;
};

struct FunctionEntry {
    const char *name;
    bool is_delta, refracts;
    Evaluated (*evaluate)(const Arguments &);
    Sampled (*sample)(const Arguments &); ///< wo of the arguments is not read
};

std::span<const FunctionEntry> float_functions();
std::span<const FunctionEntry> double_functions();

} // namespace gradus::testing
