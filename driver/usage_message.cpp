#include "driver/usage_message.h"

#include "runtime/io/text.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <vector>

namespace gradus {

namespace {

bool is_option(const std::string &word) { return word.size() > 1 && word.front() == '-'; }

/// What may have been meant; `otherwise` where nothing is near.
std::string guess(const std::string &word, const std::vector<std::string> &known, const char *otherwise = "") {
    const std::optional<std::string> nearest = nearest_name(word, known);
    return nearest ? fmt::format("; did you mean {}?", *nearest) : otherwise;
}

std::vector<std::string> commands_of(const CLI::App &app) {
    std::vector<std::string> names;
    for (const CLI::App *command : app.get_subcommands([](const CLI::App *) { return true; }))
        names.push_back(command->get_name());
    return names;
}

std::vector<std::string> options_of(const CLI::App &command) {
    std::vector<std::string> names;
    for (const CLI::Option *option : command.get_options()) {
        for (const std::string &name : option->get_lnames())
            names.push_back("--" + name);
        for (const std::string &name : option->get_snames())
            names.push_back("-" + name);
    }
    return names;
}

bool has_option(const CLI::App &command, const std::string &name) {
    const std::vector<std::string> options = options_of(command);
    return std::find(options.begin(), options.end(), name) != options.end();
}

std::vector<std::string> commands_with(const CLI::App &app, const std::string &option) {
    std::vector<std::string> names;
    for (const CLI::App *command : app.get_subcommands([](const CLI::App *) { return true; }))
        if (has_option(*command, option))
            names.push_back(command->get_name());
    return names;
}

std::string of_unknown_option(const CLI::App &app, const CLI::App &command, const std::string &name) {
    if (has_option(command, name))
        return fmt::format("{} comes after --, where no word is an option", name);
    const std::vector<std::string> others = commands_with(app, name);
    return fmt::format("{} is not an option of {}{}", name, command.get_display_name(),
                       others.empty() ? guess(name, options_of(command))
                                      : fmt::format(", but of {}", fmt::join(others, ", ")));
}

/// The first word that the command does not take, an option before others: what follows it may be its value.
std::string of_unknown_words(const CLI::App &app, const CLI::App &command, const std::vector<std::string> &words) {
    for (const std::string &word : words)
        if (is_option(word))
            return of_unknown_option(app, command, word.substr(0, word.find('=')));
    return fmt::format("{} takes no more, but was given: {}", command.get_display_name(), fmt::join(words, " "));
}

} // namespace

std::string usage_message(const CLI::App *app, const CLI::Error &error) {
    std::string text = CLI::FailureMessage::simple(app, error);
    const std::vector<CLI::App *> chosen = app->get_subcommands();
    if (chosen.empty() && !app->remaining().empty()) {
        const std::string word = app->remaining().front();
        const std::vector<std::string> commands = commands_of(*app);
        text = is_option(word)
                   ? fmt::format("{} comes before a command, which is one of {}\n", word, fmt::join(commands, ", "))
                   : fmt::format("{} is no command{} The commands are {}\n", word, guess(word, commands, "."),
                                 fmt::join(commands, ", "));
    } else if (dynamic_cast<const CLI::ExtrasError *>(&error) && !chosen.empty()) {
        text = of_unknown_words(*app, *chosen.front(), app->remaining(true)) +
               fmt::format("\nRun gradus {} --help for more information.\n", chosen.front()->get_name());
    }
    return "gradus: error: " + text;
}

} // namespace gradus
