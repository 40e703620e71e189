#include "driver/number_checks.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace gradus {
namespace {

/// What std::from_chars makes of the whole text, or nothing.
template <typename Number>
std::optional<Number> number_of(const std::string &text) {
    Number number = 0;
    const auto [stop, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (failure != std::errc{} || stop != text.data() + text.size())
        return std::nullopt;
    return number;
}

} // namespace

std::optional<double> finite_number(const std::string &text) {
    const auto number = number_of<double>(text);
    return number && std::isfinite(*number) ? number : std::nullopt;
}

CLI::Validator positive_number() {
    const auto complaint = [](const std::string &text) {
        const auto number = finite_number(text);
        return number && *number > 0 ? std::string() : fmt::format("'{}' is not a number above 0", text);
    };
    return CLI::Validator(complaint, "above 0");
}

CLI::Validator number_between(double least, double most) {
    const auto complaint = [least, most](const std::string &text) {
        const auto number = finite_number(text);
        return number && *number >= least && *number <= most
                   ? std::string()
                   : fmt::format("'{}' is not a number from {} to {}", text, least, most);
    };
    return CLI::Validator(complaint, fmt::format("{} to {}", least, most));
}

CLI::Validator whole_number_between(std::int64_t least, std::uint64_t most) {
    const auto settle = [least, most](std::string &text) {
        const bool is_negative = text.starts_with('-');
        const auto below = is_negative ? number_of<std::int64_t>(text) : std::nullopt;
        const auto above = is_negative ? std::nullopt : number_of<std::uint64_t>(text);
        const std::uint64_t lowest = least < 0 ? 0 : std::uint64_t(least);
        const bool is_allowed = (below && *below >= least) || (above && *above >= lowest && *above <= most);
        if (!is_allowed)
            return fmt::format("'{}' is not a whole number from {} to {}", text, least, most);
        text = below ? fmt::format("{}", *below) : fmt::format("{}", *above);
        return std::string();
    };
    return CLI::Validator(settle, fmt::format("{} to {}", least, most));
}

} // namespace gradus
