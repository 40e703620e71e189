// The tokens of a kernel source (C11, 6.4).
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string_view>

namespace gradus {

struct SourceToken {
    enum class Kind { identifier, number, text, punctuation, pragma };
    Kind kind = Kind::punctuation;
    std::string_view spelling; ///< a pragma's is what follows the word on its line
    std::string_view file;     ///< by the last #line before it; of a macro's tokens, where the macro was named
    int line = 0;
    bool is_painted = false; ///< names a macro within that macro, and stays as it is

    bool is(std::string_view other) const { return spelling == other; }
};

/// The text has what is not understood here.
struct NotUnderstood : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Whether this is one identifier.
bool is_source_name(std::string_view text);

/// Reads tokens of text. Newlines are not tokens: each begins a line, and a directive is the first token of its line.
class SourceLexer {
  public:
    explicit SourceLexer(std::string_view text) : text_(text) {}

    std::string_view file;
    int line = 1;

    bool at_end();
    /// Whether the next token is on the line of the last one.
    bool line_goes_on();
    bool begins_line();
    /// Whether this character is next, without a space before it.
    bool is_at(char c) const { return at_ < text_.size() && text_[at_] == c; }
    /// The rest of the line as it is, to the end of a comment that begins in it.
    std::string_view rest_of_line();
    /// Throws NotUnderstood.
    SourceToken next();

  private:
    bool is_sign_of_exponent() const;
    std::size_t length_of_punctuation() const;
    /// To the last character of the comment that begins here.
    void skip_comment();
    void skip_space();

    std::string_view text_;
    std::size_t at_ = 0;
    bool begins_line_ = true;
};

} // namespace gradus
