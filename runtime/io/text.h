// Words and numbers in scene files, read the same in every locale.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gradus {

/// What some editors begin a file in UTF-8 with; empty where it does not.
std::string_view byte_order_mark(std::string_view text);
/// Takes the next line off a text, without its end, which is that of any system.
std::string_view take_line(std::string_view &text);
/// Without blanks at either end.
std::string_view trimmed(std::string_view text);
std::string lower_case(std::string_view text);
/// "toWorld", "intIOR" and "alphaU" of the old dialect as "to_world", "int_ior" and "alpha_u".
std::string snake_case(std::string_view name);

/// The whole text as a finite number; nothing where it is none. Blanks around it and a leading plus are fine.
std::optional<double> parse_number(std::string_view text);
/// The whole text as an integer; "64.0" and "1e6" count, "1.5" does not.
std::optional<std::int64_t> parse_integer(std::string_view text);
/// "true" or "false" in any case.
std::optional<bool> parse_boolean(std::string_view text);

/// Splits at commas and blanks; several in a row count as one.
std::vector<std::string_view> split_list(std::string_view text);
/// All items of a list as numbers, or nothing if one is none.
std::optional<std::vector<double>> parse_numbers(std::string_view text);

/// The candidate closest to the name by edit distance, if it is close enough to be meant.
std::optional<std::string> nearest_name(const std::string &name, const std::vector<std::string> &candidates);
/// The beginning of the text between double quotes, for messages: up to 24 bytes, and none from the first control
/// character on.
std::string quoted_excerpt(std::string_view text);
/// The text, or its beginning and its end with "..." between them where it has more than `most` bytes: what a file says
/// may be of any length, a message not.
std::string shortened(std::string_view text, std::size_t most);
/// Items joined by ", ".
std::string join(const std::vector<std::string> &items);

} // namespace gradus
