// Numbers on the command line: decimal, finite, within bounds. CLI11's own conversion reads 010 as eight, clamps what
// does not fit and lets NaN through its ranges.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace CLI {
class Validator;
}

namespace gradus {

/// The number that the whole text is, or nothing; NaN and infinity are none.
std::optional<double> finite_number(const std::string &text);

/// Checks, for Option::check(): a number above 0; a number from `least` to `most`.
CLI::Validator positive_number();
CLI::Validator number_between(double least, double most);

/// For Option::transform(): a whole number from `least` to `most`, which CLI11 then reads as it is meant.
CLI::Validator whole_number_between(std::int64_t least, std::uint64_t most);

} // namespace gradus
