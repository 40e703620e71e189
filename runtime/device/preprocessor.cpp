#include "runtime/device/preprocessor.h"

#include "runtime/device/source_condition.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <unordered_map>
#include <utility>

namespace gradus {

namespace {

using Kind = SourceToken::Kind;
using Tokens = std::vector<SourceToken>;

struct Macro {
    bool has_parameters = false, is_variadic = false;
    std::vector<std::string_view> parameters; ///< __VA_ARGS__ is the last of a variadic one
    Tokens body;
    bool is_open = false; ///< its expansion is being read

    int parameter(const SourceToken &token) const {
        if (token.kind != Kind::identifier)
            return -1;
        const auto found = std::find(parameters.begin(), parameters.end(), token.spelling);
        return found == parameters.end() ? -1 : static_cast<int>(found - parameters.begin());
    }
};

class Preprocessor {
  public:
    Preprocessor(std::string_view text, PreprocessedSource &result) : lexer_(text), result_(result) {}

    void define(std::string_view text) {
        const std::string_view definition = result_.made.emplace_back(text);
        const std::size_t equals = definition.find('=');
        const std::string_view name = definition.substr(0, equals);
        if (!is_source_name(name))
            throw NotUnderstood("a definition with parameters");
        Macro macro;
        SourceLexer value(equals == std::string_view::npos ? "1" : definition.substr(equals + 1));
        while (!value.at_end())
            macro.body.push_back(value.next());
        macros_[name] = std::move(macro);
    }

    void run() {
        result_.tokens = expanded_rest();
        if (!conditions_.empty())
            throw NotUnderstood("#if without #endif");
    }

  private:
    /// What is read before the text goes on: the expansion of a macro, which is not expanded in there, or an argument.
    struct Frame {
        Tokens tokens;
        Macro *macro;
        std::size_t at = 0;
    };
    struct If {
        bool was_taken, is_taken, outside;
    };

    bool is_skipping() const { return !conditions_.empty() && !conditions_.back().is_taken; }

    void close_frame() {
        if (frames_.back().macro)
            frames_.back().macro->is_open = false;
        frames_.pop_back();
    }

    /// The next token, of the innermost expansion or of the text. False at the end: of the text, or of the lowest frame
    /// that may be read.
    bool next(SourceToken &token) {
        while (frames_.size() > floor_) {
            Frame &frame = frames_.back();
            if (frame.at < frame.tokens.size()) {
                token = frame.tokens[frame.at++];
                return true;
            }
            close_frame();
        }
        if (!reads_text_)
            return false;
        while (!lexer_.at_end()) {
            const bool is_directive = lexer_.begins_line() && lexer_.is_at('#');
            if (!is_directive && is_skipping()) { // what is no token may stand there
                lexer_.rest_of_line();
                continue;
            }
            token = lexer_.next();
            if (!is_directive || directive(token))
                return true;
        }
        return false;
    }

    /// Whether the next token opens an argument list; it is not taken.
    bool parenthesis_follows() {
        while (frames_.size() > floor_) {
            const Frame &frame = frames_.back();
            if (frame.at < frame.tokens.size())
                return frame.tokens[frame.at].is("(");
            close_frame();
        }
        if (!reads_text_)
            return false;
        SourceToken token;
        if (!next(token))
            return false;
        frames_.push_back({{token}, nullptr});
        return token.is("(");
    }

    /// True where the name was a macro's and its expansion is what is read next.
    bool expand(SourceToken &token) {
        if (token.is_painted)
            return false;
        const auto found = macros_.find(token.spelling);
        if (found == macros_.end())
            return false;
        Macro &macro = found->second;
        if (macro.is_open) {
            token.is_painted = true;
            return false;
        }
        std::vector<Tokens> arguments;
        if (macro.has_parameters) {
            if (!parenthesis_follows())
                return false;
            arguments = read_arguments(macro);
        }
        Tokens body = replaced(macro, arguments);
        for (SourceToken &one : body) {
            one.file = token.file;
            one.line = token.line;
        }
        frames_.push_back({std::move(body), &macro});
        macro.is_open = true;
        return true;
    }

    std::vector<Tokens> read_arguments(const Macro &macro) {
        SourceToken token;
        next(token); // the parenthesis
        std::vector<Tokens> arguments(1);
        for (int depth = 1;;) {
            if (!next(token))
                throw NotUnderstood("arguments without an end");
            depth += token.is("(") - token.is(")");
            if (depth == 0)
                break;
            if (depth == 1 && token.is(",") && !(macro.is_variadic && arguments.size() == macro.parameters.size()))
                arguments.emplace_back();
            else
                arguments.back().push_back(token);
        }
        if (macro.parameters.empty() && arguments.size() == 1 && arguments[0].empty())
            arguments.clear();
        if (macro.is_variadic && arguments.size() + 1 == macro.parameters.size())
            arguments.emplace_back();
        if (arguments.size() != macro.parameters.size())
            throw NotUnderstood("another number of arguments");
        return arguments;
    }

    /// All that may be read, with its macros expanded.
    Tokens expanded_rest() {
        Tokens result;
        SourceToken token;
        while (next(token))
            if (token.kind != Kind::identifier || !expand(token))
                result.push_back(token);
        return result;
    }

    /// All macros in tokens expanded, as if they were the rest of the text.
    Tokens expanded(const Tokens &tokens) {
        const std::size_t outer_floor = std::exchange(floor_, frames_.size());
        const bool was_within = std::exchange(reads_text_, false);
        frames_.push_back({tokens, nullptr});
        Tokens result = expanded_rest();
        floor_ = outer_floor;
        reads_text_ = was_within;
        return result;
    }

    SourceToken joined(const SourceToken &left, const SourceToken &right) {
        result_.made.push_back(std::string(left.spelling) + std::string(right.spelling));
        SourceLexer lexer(result_.made.back());
        SourceToken token = lexer.next();
        if (token.spelling.size() != result_.made.back().size())
            throw NotUnderstood("## of what is no token");
        return token;
    }

    /// The body with its arguments in place.
    Tokens replaced(const Macro &macro, const std::vector<Tokens> &arguments) {
        Tokens result;
        std::vector<std::optional<Tokens>> whole(arguments.size());
        bool joins = false;
        const auto append = [&](const Tokens &tokens) {
            for (const SourceToken &token : tokens) {
                if (std::exchange(joins, false) && !result.empty())
                    result.back() = joined(result.back(), token);
                else
                    result.push_back(token);
            }
        };
        for (std::size_t i = 0; i < macro.body.size(); ++i) {
            const SourceToken &token = macro.body[i];
            if (token.is("##")) {
                joins = true;
                continue;
            }
            const int parameter = macro.has_parameters ? macro.parameter(token) : -1;
            if (parameter < 0) {
                if (macro.has_parameters && token.is("#"))
                    throw NotUnderstood("# of an argument");
                append({token});
                continue;
            }
            const auto index = static_cast<std::size_t>(parameter);
            const bool is_joined = joins || (i + 1 < macro.body.size() && macro.body[i + 1].is("##"));
            if (is_joined) {
                if (arguments[index].empty())
                    throw NotUnderstood("## of nothing");
                append(arguments[index]);
                continue;
            }
            if (!whole[index])
                whole[index] = expanded(arguments[index]);
            append(*whole[index]);
        }
        return result;
    }

    Tokens rest_of_line() {
        Tokens tokens;
        while (lexer_.line_goes_on())
            tokens.push_back(lexer_.next());
        return tokens;
    }

    std::int64_t condition() {
        Tokens tokens;
        const Tokens line = rest_of_line();
        for (std::size_t i = 0; i < line.size(); ++i) {
            if (!line[i].is("defined")) {
                tokens.push_back(line[i]);
                continue;
            }
            const bool in_parentheses = i + 3 < line.size() && line[i + 1].is("(");
            const std::size_t name = i + (in_parentheses ? 2 : 1);
            if (name >= line.size())
                throw NotUnderstood("defined of nothing");
            SourceToken number = line[name];
            number.kind = Kind::number;
            number.spelling = macros_.contains(line[name].spelling) ? "1" : "0";
            tokens.push_back(number);
            i = name + (in_parentheses ? 1 : 0);
        }
        return value_of_condition(expanded(tokens));
    }

    void read_macro() {
        if (!lexer_.line_goes_on())
            throw NotUnderstood("#define of nothing");
        const SourceToken name = lexer_.next();
        Macro macro;
        macro.has_parameters = lexer_.is_at('(');
        const Tokens line = rest_of_line();
        std::size_t at = 0;
        if (macro.has_parameters) {
            for (at = 1; at < line.size() && !line[at].is(")"); ++at) {
                if (line[at].is(","))
                    continue;
                macro.is_variadic = line[at].is("...");
                macro.parameters.push_back(macro.is_variadic ? "__VA_ARGS__" : line[at].spelling);
            }
            if (at == line.size())
                throw NotUnderstood("parameters without an end");
            ++at;
        }
        macro.body.assign(line.begin() + static_cast<std::ptrdiff_t>(at), line.end());
        macros_[name.spelling] = std::move(macro);
    }

    /// A directive of the text, of which "#" was read. True where it leaves a token.
    bool directive(SourceToken &token) {
        if (!lexer_.line_goes_on())
            return false;
        const SourceToken name = lexer_.next();
        if (name.is("if") || name.is("ifdef") || name.is("ifndef")) {
            const bool outside = is_skipping();
            bool holds = false;
            if (outside)
                lexer_.rest_of_line();
            else if (name.is("if"))
                holds = condition() != 0;
            else if (const Tokens line = rest_of_line(); line.size() == 1)
                holds = macros_.contains(line[0].spelling) == name.is("ifdef");
            else
                throw NotUnderstood("#ifdef of other things");
            conditions_.push_back({holds, holds, outside});
        } else if (name.is("elif") || name.is("else")) {
            if (conditions_.empty())
                throw NotUnderstood("#else without #if");
            If &open = conditions_.back();
            const bool may = !open.outside && !open.was_taken;
            open.is_taken = false;
            if (!may)
                lexer_.rest_of_line();
            else
                open.was_taken = open.is_taken = name.is("else") || condition() != 0;
        } else if (name.is("endif")) {
            if (conditions_.empty())
                throw NotUnderstood("#endif without #if");
            conditions_.pop_back();
        } else if (is_skipping()) {
            lexer_.rest_of_line();
        } else if (name.is("define")) {
            read_macro();
        } else if (name.is("undef")) {
            for (const SourceToken &macro : rest_of_line())
                macros_.erase(macro.spelling);
        } else if (name.is("line")) {
            const Tokens line = rest_of_line();
            if (line.size() != 2 || line[1].spelling.size() < 2)
                throw NotUnderstood("#line of other things");
            lexer_.file = line[1].spelling.substr(1, line[1].spelling.size() - 2);
            int next = 0; // the number of the line after this one; more lines may have been passed
            std::from_chars(line[0].spelling.data(), line[0].spelling.data() + line[0].spelling.size(), next);
            lexer_.line += next - name.line - 1;
        } else if (name.is("pragma")) {
            token = name;
            token.kind = Kind::pragma;
            token.spelling = lexer_.rest_of_line();
            return true;
        } else {
            throw NotUnderstood("a directive");
        }
        return false;
    }

    SourceLexer lexer_;
    PreprocessedSource &result_;
    std::unordered_map<std::string_view, Macro> macros_;
    std::vector<Frame> frames_;
    std::size_t floor_ = 0;  ///< frames below are not to be read
    bool reads_text_ = true; ///< nor the text where not so
    std::vector<If> conditions_;
};

} // namespace

std::optional<PreprocessedSource> preprocessed(std::string_view text, const std::vector<std::string> &definitions) {
    PreprocessedSource result;
    try {
        Preprocessor preprocessor(text, result);
        preprocessor.define("__OPENCL_VERSION__=120");
        for (const std::string &definition : definitions)
            preprocessor.define(definition);
        preprocessor.run();
    } catch (const NotUnderstood &) {
        return std::nullopt;
    }
    return result;
}

} // namespace gradus
