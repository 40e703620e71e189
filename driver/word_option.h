// Options whose value is one of a few words.
#pragma once

#include <CLI/CLI.hpp>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace gradus {

template <class Value>
using Words = std::vector<std::pair<std::string, Value>>;

/// `standard` is the default, which the help names; `set` is called where the option is given. `filters` are those of
/// CLI::IsMember, such as CLI::ignore_case.
template <class Value, class... Filters>
CLI::Option *add_word_option(CLI::App &command, const std::string &name, const Words<Value> &words, Value standard,
                             std::function<void(Value)> set, const std::string &text, Filters... filters) {
    std::vector<std::string> known;
    std::string word_of_standard;
    for (const auto &[word, value] : words) {
        known.push_back(word);
        if (value == standard)
            word_of_standard = word;
    }
    const auto take = [words, set = std::move(set)](const std::string &given) {
        set(std::find_if(words.begin(), words.end(), [&](const auto &word) { return word.first == given; })->second);
    };
    return command.add_option_function<std::string>(name, take, text)
        ->transform(CLI::IsMember(known, filters...)) // into the word as it is spelt here
        ->default_str(word_of_standard);
}

} // namespace gradus
