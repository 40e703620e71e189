// In which arithmetic kernels are compiled.
#pragma once

#include <cstddef>

namespace gradus {

/// `relaxed`: float, and the compiler may reorder, join and approximate (-cl-fast-relaxed-math).
enum class Precision { single, relaxed, double_ };

constexpr std::size_t real_bytes(Precision precision) { return precision == Precision::double_ ? 8 : 4; }

/// As the command line writes it.
constexpr const char *precision_name(Precision precision) {
    return precision == Precision::double_ ? "double" : precision == Precision::relaxed ? "relaxed" : "single";
}

} // namespace gradus
