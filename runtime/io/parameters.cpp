#include "runtime/io/parameters.h"

#include "runtime/error.h"
#include "runtime/io/diagnostics.h"
#include "runtime/io/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace gradus {

namespace {

constexpr int deepest = 16;
constexpr std::size_t longest_name = 100;

[[noreturn]] void fail(const Location &location, const std::string &message) {
    throw Error(ExitCode::scene, located(location, message));
}

std::string megabytes(std::uint64_t bytes) { return std::to_string(bytes >> 20) + " MiB"; }

bool is_of_name(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || (c & 0x80) != 0;
}

std::string circle(const std::string &text) {
    return fmt::format("\"{}\": parameters name each other in a circle", shortened(text, 200));
}

std::vector<std::string> names_of(const std::map<std::string, std::string, std::less<>> &values) {
    std::vector<std::string> names;
    for (const auto &[name, value] : values)
        names.push_back(name);
    return names;
}

} // namespace

Parameters::Parameters(const std::map<std::string, std::string> &given, const LoadLimits &limits)
    : given_(given), limits_(limits), values_(given.begin(), given.end()) {
    for (const auto &[name, value] : values_)
        longest_name_ = std::max(longest_name_, name.size());
}

void Parameters::add_default(const std::string &name, const std::string &value, const Location &location) {
    if (name.size() > longest_name)
        fail(location, "<default>: a name of " + std::to_string(name.size()) + " letters; at most " +
                           std::to_string(longest_name) + " are read");
    used_.insert(name);
    if (!values_.emplace(name, value).second)
        return;
    longest_name_ = std::max(longest_name_, name.size());
    expanded_.clear(); // a longer name may be known now
}

const std::string *Parameters::expanded(const std::string &name, const std::string &value, const Location &location,
                                        int depth) {
    used_.insert(name);
    const auto known = expanded_.find(name);
    if (known != expanded_.end())
        return &known->second;
    std::string result;
    if (!append(value, location, depth, result))
        return nullptr;
    return &expanded_.emplace(name, std::move(result)).first->second;
}

bool Parameters::append(std::string_view text, const Location &location, int depth, std::string &result) {
    if (depth > deepest) {
        problems_.clear();
        return false;
    }
    bool is_known = true;
    while (!text.empty()) {
        const std::size_t dollar = std::min(text.find('$'), text.size());
        result += text.substr(0, dollar);
        text.remove_prefix(dollar);
        if (text.empty())
            break;
        text.remove_prefix(1);
        std::size_t size = 0;
        while (size < std::min(text.size(), std::max(longest_name_, longest_name)) && is_of_name(text[size]))
            ++size;
        const std::string_view whole = text.substr(0, size);
        // "$width_wide" may be $width with a tail: the longest name that is known.
        size = std::min(size, longest_name_);
        auto found = values_.end();
        while (size > 0 && (found = values_.find(whole.substr(0, size))) == values_.end())
            --size;
        if (size == 0) {
            problems_.push_back(whole.empty() ? " " : std::string(whole));
            is_known = false;
            text.remove_prefix(whole.size());
            continue;
        }
        text.remove_prefix(size);
        const std::string *value = expanded(found->first, found->second, location, depth + 1);
        if (!value) {
            if (problems_.empty()) // a circle
                return false;
            is_known = false;
            continue;
        }
        result += *value;
        if (result.size() > limits_.value_bytes)
            fail(location,
                 "parameters expand to more than " + megabytes(limits_.value_bytes) + " of text" + limits_hint);
        spent_ += value->size() + 1; // one that stands for nothing takes its time, too
        if (spent_ > limits_.expanded_bytes)
            fail(location, "all parameters together expand to more than " + megabytes(limits_.expanded_bytes) +
                               " of text" + limits_hint);
    }
    return is_known;
}

bool Parameters::try_expand(const std::string &text, const Location &location, std::string &result) {
    result.clear();
    problems_.clear();
    if (text.find('$') != std::string::npos)
        return append(text, location, 0, result);
    result = text;
    return true;
}

std::string Parameters::expand(const std::string &text, const Location &location) {
    std::string result;
    if (!try_expand(text, location, result))
        fail(location, problems_.empty() ? circle(text) : told_missing(problems_.front()));
    return result;
}

std::string Parameters::expand_or_tell(const std::string &text, const Location &location, Diagnostics &diagnostics) {
    std::string result;
    if (try_expand(text, location, result))
        return result;
    if (problems_.empty())
        fail(location, circle(text));
    for (const std::string &problem : problems_)
        if (told_.insert(problem).second)
            diagnostics.error(location, told_missing(problem));
    return "";
}

std::string Parameters::told_missing(const std::string &problem) const {
    const std::string name(trimmed(problem));
    std::string message = "parameter $" + name + " has no value: give -D " + name + "=... or a <default> for it";
    if (const auto nearest = nearest_name(name, names_of(values_)))
        message += "; did you mean $" + *nearest + "?";
    return message;
}

void Parameters::check_given() const {
    std::string message;
    const std::vector<std::string> known(used_.begin(), used_.end());
    for (const auto &[name, value] : given_) {
        if (used_.count(name))
            continue;
        message += message.empty() ? "-D " : "\n-D ";
        message += name + ": the scene has no parameter of that name";
        if (const auto nearest = nearest_name(name, known))
            message += "; did you mean " + *nearest + "?";
        message += known.empty() ? " (it has none)" : " (it has: " + shortened(join(known), 1000) + ")";
    }
    if (!message.empty())
        throw Error(ExitCode::scene, message);
}

} // namespace gradus
