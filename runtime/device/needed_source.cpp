#include "runtime/device/needed_source.h"

#include "runtime/device/preprocessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gradus {

namespace {

using Kind = SourceToken::Kind;

/// A function, or a declaration: what ends with a body or a semicolon outside of all others. A pragma outside of them.
struct Item {
    std::size_t first, end; ///< tokens
    std::vector<std::string_view> names;
    bool is_needed = false;
};

/// The token after the parenthesis that closes the one at `at`.
std::size_t after_parenthesis(const std::vector<SourceToken> &tokens, std::size_t at, std::size_t end) {
    for (int depth = 0; at < end; ++at) {
        depth += tokens[at].is("(") - tokens[at].is(")");
        if (depth == 0)
            return at + 1;
    }
    return end;
}

/// The comma or semicolon after the value that begins at `at`.
std::size_t after_value(const std::vector<SourceToken> &tokens, std::size_t at, std::size_t end) {
    for (int depth = 0; at < end; ++at) {
        const SourceToken &token = tokens[at];
        if (depth == 0 && (token.is(",") || token.is(";")))
            return at;
        depth += token.is("(") + token.is("[") + token.is("{") - token.is(")") - token.is("]") - token.is("}");
    }
    return end;
}

/// What can be named elsewhere: a function; all of an enumeration; else each name that ends a declarator, and a tag.
std::vector<std::string_view> names_of(const std::vector<SourceToken> &tokens, std::size_t first, std::size_t end) {
    std::vector<std::string_view> names;
    bool is_enumeration = false;
    int depth = 0;
    for (std::size_t i = first; i < end; ++i) {
        const SourceToken &token = tokens[i];
        if (token.is("__attribute__")) {
            i = after_parenthesis(tokens, i + 1, end) - 1;
            continue;
        }
        if (depth == 0 && token.is("=")) { // a value; what it names is needed, not given
            i = after_value(tokens, i + 1, end) - 1;
            continue;
        }
        depth += token.is("{") + token.is("[") - token.is("}") - token.is("]");
        if (token.kind != Kind::identifier)
            continue;
        if (token.is("enum")) {
            is_enumeration = true;
            continue;
        }
        const SourceToken *after = i + 1 < end ? &tokens[i + 1] : nullptr;
        if (depth == 0 && after && after->is("(") && !is_enumeration)
            return {token.spelling};
        const bool ends_declarator =
            after && (after->is(";") || after->is(",") || after->is("=") || after->is("[") || after->is("{"));
        if (is_enumeration || (depth == 0 && ends_declarator))
            names.push_back(token.spelling);
    }
    return names;
}

std::vector<Item> items_of(const std::vector<SourceToken> &tokens) {
    std::vector<Item> items;
    std::size_t first = 0;
    int depth = 0;
    bool has_body_of_function = false;
    const auto close = [&](std::size_t end) {
        items.push_back({first, end, names_of(tokens, first, end)});
        first = end;
        has_body_of_function = false;
    };
    for (std::size_t i = 0; i < tokens.size(); ++i) {
        const SourceToken &token = tokens[i];
        if (token.kind == Kind::pragma) {
            if (depth == 0 && i == first)
                close(i + 1);
            continue;
        }
        if (depth == 0 && token.is("{"))
            has_body_of_function = i > first && tokens[i - 1].is(")");
        depth += token.is("{") + token.is("(") - token.is("}") - token.is(")");
        if (depth == 0 && (token.is(";") || (token.is("}") && has_body_of_function)))
            close(i + 1);
    }
    if (first != tokens.size())
        close(tokens.size());
    return items;
}

/// Marks kernels, what has no name, and whatever those name.
void mark_needed(const std::vector<SourceToken> &tokens, std::vector<Item> &items) {
    std::unordered_map<std::string_view, std::vector<Item *>> by_name;
    std::vector<Item *> open;
    const auto need = [&](Item &item) {
        if (!std::exchange(item.is_needed, true))
            open.push_back(&item);
    };
    for (Item &item : items) {
        const auto begin = tokens.begin() + static_cast<std::ptrdiff_t>(item.first),
                   end = tokens.begin() + static_cast<std::ptrdiff_t>(item.end);
        const bool is_kernel = std::any_of(
            begin, end, [](const SourceToken &token) { return token.is("__kernel") || token.is("kernel"); });
        if (item.names.empty() || is_kernel)
            need(item);
        for (const std::string_view name : item.names)
            by_name[name].push_back(&item);
    }
    while (!open.empty()) {
        const Item item = *open.back();
        open.pop_back();
        for (std::size_t i = item.first; i < item.end; ++i)
            if (tokens[i].kind == Kind::identifier)
                if (const auto found = by_name.find(tokens[i].spelling); found != by_name.end())
                    for (Item *named : found->second)
                        need(*named);
    }
}

/// A token and what parts it from the next one. A pragma takes a line of its own.
std::string spelled(const SourceToken &token) {
    const std::string spelling(token.spelling);
    return token.kind == Kind::pragma ? "\n#pragma" + spelling + '\n' : spelling + ' ';
}

/// Writes tokens on the lines that they stood on.
class Writer {
  public:
    std::string text;

    void write(const SourceToken &token) {
        constexpr int few = 4; // empty lines are shorter than a directive
        const bool goes_on = token.file == file_ && token.line >= line_ && token.line <= line_ + few;
        if (goes_on)
            text.append(static_cast<std::size_t>(token.line - line_), '\n');
        else
            text += fmt::format("\n#line {} \"{}\"\n", token.line, token.file);
        text += spelled(token);
        file_ = token.kind == Kind::pragma ? std::string_view() : token.file; // which has lines more than there were
        line_ = token.line;
    }

  private:
    std::string_view file_;
    int line_ = 0;
};

struct Options {
    std::vector<std::string> definitions;
    std::string rest;
};

/// None where an option has more than words.
std::optional<Options> split(const std::string &options) {
    Options result;
    std::istringstream words(options);
    for (std::string word; words >> word;) {
        if (word.find_first_of("\"'\\") != std::string::npos)
            return std::nullopt;
        std::string definition;
        if (word == "-D")
            words >> definition;
        else if (word.starts_with("-D"))
            definition = word.substr(2);
        if (!definition.empty())
            result.definitions.push_back(definition);
        if (definition.empty() || definition.starts_with('_'))
            result.rest += (result.rest.empty() ? "" : " ") + word + (word == "-D" ? " " + definition : "");
    }
    return result;
}

} // namespace

std::optional<NeededSource> needed_source(const std::string &text, const std::string &options) {
    const std::optional<Options> given = split(options);
    const std::optional<PreprocessedSource> source = given ? preprocessed(text, given->definitions) : std::nullopt;
    if (!source)
        return std::nullopt;
    std::vector<Item> items = items_of(source->tokens);
    mark_needed(source->tokens, items);
    NeededSource needed;
    needed.options = "-w " + given->rest; // compilers are told of macros where parentheses are more than are needed
    Writer writer;
    for (const Item &item : items) {
        if (!item.is_needed)
            continue;
        for (std::size_t i = item.first; i < item.end; ++i) {
            writer.write(source->tokens[i]);
            needed.meaning += spelled(source->tokens[i]);
        }
    }
    needed.text = std::move(writer.text);
    return needed;
}

} // namespace gradus
