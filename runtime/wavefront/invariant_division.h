// Division by a number that is known before a kernel starts, as a multiplication.
#pragma once

#include <cstdint>

namespace gradus {

/// floor(n / divisor) = (n * multiplier >> 32) >> shift for all n < 2^31; multiplier 0 stands for a divisor of 1.
struct InvariantDivision {
    std::uint32_t multiplier, shift;
};

/// Granlund and Montgomery, "Division by Invariant Integers using Multiplication", PLDI 1994, theorem 4.2: with
/// l = ceil(log2 divisor) the multiplier ceil(2^(31 + l) / divisor) is exact for 31-bit numbers, and it fits 32 bits
/// but for a divisor of 1.
inline InvariantDivision invariant_division(std::uint32_t divisor) {
    if (divisor <= 1)
        return {0, 0};
    std::uint32_t log = 0;
    while ((std::uint64_t(1) << log) < divisor)
        ++log;
    const std::uint64_t power = std::uint64_t(1) << (31 + log);
    return {static_cast<std::uint32_t>((power + divisor - 1) / divisor), log - 1};
}

} // namespace gradus
