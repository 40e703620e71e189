// In which arithmetic kernels are compiled.
#pragma once

#include <cstddef>

namespace gradus {

enum class Precision { single, relaxed, double_ };

constexpr std::size_t real_bytes(Precision precision) { return precision == Precision::double_ ? 8 : 4; }

} // namespace gradus
