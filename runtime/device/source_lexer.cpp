#include "runtime/device/source_lexer.h"

#include <algorithm>
#include <cctype>

namespace gradus {

namespace {

bool begins_name(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool is_of_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

} // namespace

bool is_source_name(std::string_view text) {
    return !text.empty() && begins_name(text[0]) && std::all_of(text.begin(), text.end(), is_of_name);
}

bool SourceLexer::at_end() {
    skip_space();
    return at_ == text_.size();
}

bool SourceLexer::line_goes_on() {
    skip_space();
    return at_ < text_.size() && !begins_line_;
}

bool SourceLexer::begins_line() {
    skip_space();
    return begins_line_;
}

std::string_view SourceLexer::rest_of_line() {
    const std::size_t start = at_;
    bool is_comment = false;
    for (; at_ < text_.size() && text_[at_] != '\n'; ++at_) {
        if (text_.substr(at_, 2) == "//")
            is_comment = true; // what begins in it is none
        else if (text_.substr(at_, 2) == "/*" && !is_comment)
            skip_comment();
        else if (text_.substr(at_, 2) == "\\\n") {
            ++at_;
            ++line;
        }
    }
    return text_.substr(start, at_ - start);
}

SourceToken SourceLexer::next() {
    skip_space();
    SourceToken token;
    token.file = file;
    token.line = line;
    begins_line_ = false;
    const std::size_t start = at_;
    const char c = text_[at_];
    if (begins_name(c)) {
        token.kind = SourceToken::Kind::identifier;
        while (at_ < text_.size() && is_of_name(text_[at_]))
            ++at_;
    } else if (is_digit(c) || (c == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1]))) {
        token.kind = SourceToken::Kind::number;
        while (at_ < text_.size() && (is_of_name(text_[at_]) || text_[at_] == '.' || is_sign_of_exponent()))
            ++at_;
    } else if (c == '"' || c == '\'') {
        token.kind = SourceToken::Kind::text;
        for (++at_; at_ < text_.size() && text_[at_] != c && text_[at_] != '\n'; ++at_)
            at_ += text_[at_] == '\\';
        if (at_ >= text_.size() || text_[at_] == '\n')
            throw NotUnderstood("a text without an end");
        ++at_;
    } else {
        token.kind = SourceToken::Kind::punctuation;
        at_ += length_of_punctuation();
    }
    token.spelling = text_.substr(start, at_ - start);
    return token;
}

bool SourceLexer::is_sign_of_exponent() const {
    const char before = text_[at_ - 1];
    return (text_[at_] == '+' || text_[at_] == '-') &&
           (before == 'e' || before == 'E' || before == 'p' || before == 'P');
}

std::size_t SourceLexer::length_of_punctuation() const {
    static constexpr std::string_view longer[] = {"<<=", ">>=", "...", "->", "++", "--", "<<", ">>",
                                                  "<=",  ">=",  "==",  "!=", "&&", "||", "*=", "/=",
                                                  "%=",  "+=",  "-=",  "&=", "^=", "|=", "##"};
    for (const std::string_view one : longer)
        if (text_.substr(at_, one.size()) == one)
            return one.size();
    return 1;
}

void SourceLexer::skip_comment() {
    const std::size_t end = text_.find("*/", at_ + 2);
    if (end == std::string_view::npos)
        throw NotUnderstood("a comment without an end");
    const std::string_view comment = text_.substr(at_, end - at_);
    line += static_cast<int>(std::count(comment.begin(), comment.end(), '\n'));
    at_ = end + 1;
}

void SourceLexer::skip_space() {
    for (; at_ < text_.size(); ++at_) {
        const char c = text_[at_], after = at_ + 1 < text_.size() ? text_[at_ + 1] : '\0';
        if (c == '\n') {
            ++line;
            begins_line_ = true;
        } else if (c == '\\' && after == '\n') {
            ++line;
            ++at_;
        } else if (c == '/' && after == '*') {
            skip_comment();
        } else if (c == '/' && after == '/') {
            for (; at_ + 1 < text_.size() && (text_[at_ + 1] != '\n' || text_[at_] == '\\'); ++at_)
                line += text_[at_ + 1] == '\n';
        } else if (c != ' ' && c != '\t' && c != '\r' && c != '\f' && c != '\v') {
            return;
        }
    }
}

} // namespace gradus
