#include "runtime/io/text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numeric>

namespace gradus {

namespace {
// std::isspace and its like depend on the locale.
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v'; }
bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }
char lower(char c) { return is_upper(c) ? char(c - 'A' + 'a') : c; }
} // namespace

std::string_view byte_order_mark(std::string_view text) {
    return text.starts_with("\xEF\xBB\xBF") ? text.substr(0, 3) : std::string_view();
}

std::string_view take_line(std::string_view &text) {
    const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
    const std::string_view rest = text.substr(line.size());
    text = rest.substr(rest.starts_with("\r\n") ? 2 : std::min<std::size_t>(1, rest.size()));
    return line;
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_blank(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back()))
        text.remove_suffix(1);
    return text;
}

std::string lower_case(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(), lower);
    return result;
}

std::string snake_case(std::string_view name) {
    std::string result;
    for (std::size_t i = 0; i < name.size(); ++i) {
        if (is_upper(name[i]) && i > 0 && !is_upper(name[i - 1]) && name[i - 1] != '_')
            result += '_';
        result += lower(name[i]);
    }
    return result;
}

std::optional<double> parse_number(std::string_view text) {
    text = trimmed(text);
    if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+')
        text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc::result_out_of_range && end == text.data() + text.size()) {
        // Too small for a double is zero to every use; too large is an error.
        const std::size_t exponent = text.find_first_of("eE");
        const bool tiny = exponent != std::string_view::npos && text.find('-', exponent) != std::string_view::npos;
        return tiny ? std::optional<double>(0) : std::nullopt;
    }
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        return std::nullopt;
    return value;
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
    const std::optional<double> value = parse_number(text);
    if (!value || *value != std::floor(*value) || std::fabs(*value) > 9e15)
        return std::nullopt;
    return std::int64_t(*value);
}

std::optional<bool> parse_boolean(std::string_view text) {
    const std::string word = lower_case(trimmed(text));
    if (word == "true")
        return true;
    if (word == "false")
        return false;
    return std::nullopt;
}

std::vector<std::string_view> split_list(std::string_view text) {
    std::vector<std::string_view> items;
    std::size_t begin = 0;
    const auto is_separator = [](char c) { return c == ',' || is_blank(c); };
    while (begin < text.size()) {
        if (is_separator(text[begin])) {
            ++begin;
            continue;
        }
        std::size_t end = begin;
        while (end < text.size() && !is_separator(text[end]))
            ++end;
        items.push_back(text.substr(begin, end - begin));
        begin = end;
    }
    return items;
}

std::optional<std::vector<double>> parse_numbers(std::string_view text) {
    std::vector<double> numbers;
    for (std::string_view item : split_list(text)) {
        const std::optional<double> number = parse_number(item);
        if (!number)
            return std::nullopt;
        numbers.push_back(*number);
    }
    return numbers;
}

namespace {
/// Levenshtein's distance, row by row; `enough` or more where it is not less than that.
std::size_t edit_distance(const std::string &a, const std::string &b, std::size_t enough) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t(0));
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t above = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (lower(a[i - 1]) != lower(b[j - 1]))});
            diagonal = above;
        }
        if (*std::min_element(row.begin(), row.end()) >= enough)
            return enough;
    }
    return row[b.size()];
}
} // namespace

std::optional<std::string> nearest_name(const std::string &name, const std::vector<std::string> &candidates) {
    std::optional<std::string> nearest;
    constexpr std::size_t longest = 100; // nobody misspells more
    if (name.size() > longest)
        return nearest;
    // A third of the letters may differ: a guess further off than that misleads.
    std::size_t best = name.size() / 3 + 2;
    for (const std::string &candidate : candidates) {
        // The lengths alone may differ by more.
        if (candidate.size() >= name.size() + best || name.size() >= candidate.size() + best)
            continue;
        const std::size_t distance = edit_distance(name, candidate, best);
        if (distance < best) {
            best = distance;
            nearest = candidate;
        }
    }
    return nearest;
}

namespace {
/// Of UTF-8.
bool is_inside_a_letter(char c) { return (c & 0xc0) == 0x80; }
} // namespace

std::string quoted_excerpt(std::string_view text) {
    constexpr std::size_t longest = 24;
    // A terminal obeys control characters.
    const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
    std::size_t end = 0;
    while (end < std::min(text.size(), longest) && !is_control(text[end]))
        ++end;
    while (end > 0 && end < text.size() && is_inside_a_letter(text[end]))
        --end;
    std::string result("\"");
    result.append(text.substr(0, end));
    result.append("\"");
    return result;
}

std::string shortened(std::string_view text, std::size_t most) {
    if (text.size() <= most)
        return std::string(text);
    std::size_t head = most * 3 / 4, tail = text.size() - most / 4;
    while (head > 0 && is_inside_a_letter(text[head]))
        --head;
    while (tail < text.size() && is_inside_a_letter(text[tail]))
        ++tail;
    return std::string(text.substr(0, head)) + "..." + std::string(text.substr(tail));
}

std::string join(const std::vector<std::string> &items) {
    std::string text;
    for (const std::string &item : items)
        text += (text.empty() ? "" : ", ") + item;
    return text;
}

} // namespace gradus
