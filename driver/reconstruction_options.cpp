#include "driver/reconstruction_options.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace gradus {

std::optional<double> finite_number(const std::string &text) {
    double number = 0;
    const auto [stop, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (failure != std::errc{} || stop != text.data() + text.size() || !std::isfinite(number))
        return std::nullopt;
    return number;
}

void add_norm_option(CLI::App &command, const char *group, std::function<void(PoissonNorm)> set) {
    command
        .add_option_function<std::string>(
            "--norm",
            [set = std::move(set)](const std::string &name) {
                set(name.back() == '1' ? PoissonNorm::l1 : PoissonNorm::l2);
            },
            "L1: robust; L2: linear")
        ->check(CLI::IsMember({"L1", "L2"}, CLI::ignore_case))
        ->default_str("L1")
        ->group(group);
}

void add_alpha_option(CLI::App &command, const char *group, const char *standard, const char *text,
                      std::function<void(std::optional<double>)> set) {
    const auto complaint = [](std::string &value) {
        const auto number = finite_number(value);
        return value == "auto" || (number && *number >= 0)
                   ? std::string()
                   : fmt::format("'{}' is neither a number from 0 on nor auto", value);
    };
    command
        .add_option_function<std::string>(
            "--alpha", [set = std::move(set)](const std::string &value) { set(finite_number(value)); }, text)
        ->type_name("NUMBER|auto")
        ->check(CLI::Validator(complaint, ""))
        ->default_str(standard)
        ->group(group);
}

} // namespace gradus
