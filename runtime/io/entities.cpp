#include "runtime/io/entities.h"

#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace gradus {

namespace {

bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

/// Reads a declaration word by word.
class Words {
  public:
    explicit Words(std::string_view text) : text_(text) {}
    void skip_space() {
        while (!text_.empty() && is_space(text_.front()))
            text_.remove_prefix(1);
    }
    std::string_view word() {
        skip_space();
        const auto end = std::find_if(text_.begin(), text_.end(), is_space);
        return take(std::size_t(end - text_.begin()));
    }
    /// Between quotes of either kind.
    std::optional<std::string_view> quoted() {
        skip_space();
        if (text_.empty() || (text_.front() != '"' && text_.front() != '\''))
            return std::nullopt;
        const std::size_t end = text_.find(text_.front(), 1);
        if (end == std::string_view::npos)
            return std::nullopt;
        return take(end + 1).substr(1, end - 1);
    }

  private:
    std::string_view take(std::size_t count) {
        const std::string_view taken = text_.substr(0, count);
        text_.remove_prefix(count);
        return taken;
    }
    std::string_view text_;
};

std::string replaced(std::string_view text, char from, std::string_view to) {
    std::string result;
    for (const char c : text)
        if (c == from)
            result += to;
        else
            result += c;
    return result;
}

/// Where the first of the characters wanted is that no quotes of either kind are around, or npos.
std::size_t find_outside_quotes(std::string_view text, std::string_view wanted, std::size_t at) {
    for (; at < text.size(); ++at) {
        if (wanted.find(text[at]) != std::string_view::npos)
            return at;
        if (text[at] != '"' && text[at] != '\'')
            continue;
        at = text.find(text[at], at + 1);
        if (at == std::string_view::npos)
            break;
    }
    return std::string_view::npos;
}

/// Behind the comment, the instruction or the declaration that begins at `at`; npos where it has no end.
std::size_t behind_markup(std::string_view text, std::size_t at) {
    const std::string_view rest = text.substr(at);
    const std::string_view end = rest.starts_with("<!--") ? "-->" : rest.starts_with("<?") ? "?>" : ">";
    const std::size_t found = end == ">" ? find_outside_quotes(text, end, at) : text.find(end, at);
    return found == std::string_view::npos ? found : found + end.size();
}

/// What a declaration, from behind "<!ENTITY" on, puts in the place of which name.
std::optional<std::pair<std::string, std::string>> declared(std::string_view declaration) {
    Words words(declaration);
    const std::string name(words.word());
    if (const auto value = words.quoted())
        return std::pair{name, replaced(replaced(*value, '\n', " "), '\r', " ")};
    if (words.word() != "SYSTEM")
        return std::nullopt;
    const auto file = words.quoted();
    if (!file)
        return std::nullopt;
    return std::pair{name, std::string("<include ") + entity_attribute + "=\"" + name + "\" filename=\"" +
                               replaced(*file, '"', "&quot;") + "\"/>"};
}

using Entities = std::map<std::string, std::string, std::less<>>;

/// What a <!DOCTYPE> declares, and where it ends.
struct DocumentType {
    Entities entities;
    std::size_t end;
};

/// That of a file, which stands before all elements. Nothing where there is none, or one that declares nothing or is
/// not well-formed.
std::optional<DocumentType> document_type(std::string_view text) {
    constexpr std::size_t nowhere = std::string_view::npos;
    std::size_t at = text.find('<');
    while (at != nowhere && !text.substr(at).starts_with("<!DOCTYPE")) {
        if (text.substr(at, 2) != "<!" && text.substr(at, 2) != "<?")
            return std::nullopt;
        at = text.find('<', behind_markup(text, at));
    }
    const std::size_t bracket = find_outside_quotes(text, "[>", at);
    if (bracket == nowhere || text[bracket] == '>')
        return std::nullopt;
    DocumentType type;
    constexpr std::string_view entity = "<!ENTITY";
    for (at = bracket + 1; (at = text.find_first_of("<]", at)) != nowhere && text[at] == '<';) {
        const std::size_t end = behind_markup(text, at);
        if (end == nowhere)
            return std::nullopt;
        if (const std::string_view markup = text.substr(at, end - at - 1); markup.starts_with(entity))
            if (auto found = declared(markup.substr(entity.size())))
                type.entities.insert(*std::move(found));
        at = end;
    }
    type.end = find_outside_quotes(text, ">", at);
    if (type.end == nowhere || type.entities.empty())
        return std::nullopt;
    return type;
}

/// A text with entities in their places, those in the values of others too.
class Expansion {
  public:
    Expansion(const Entities &entities, std::size_t most_bytes) : entities_(entities), most_bytes_(most_bytes) {}

    /// False where texts and values, as often as they are read, come to more than `most_bytes`.
    bool append(std::string_view text) {
        constexpr std::size_t bytes_a_reference = 64; // what looking one up is worth: many may stand for nothing
        bytes_ += text.size() + bytes_a_reference;
        if (bytes_ > most_bytes_)
            return false;
        for (std::size_t at = 0; at < text.size();) {
            const std::size_t ampersand = std::min(text.find('&', at), text.size());
            result_.append(text, at, ampersand - at);
            at = ampersand;
            if (at == text.size())
                break;
            // Each of many ampersands ends the search of another.
            const std::size_t end = text.find_first_of(";&", at + 1);
            const std::string *const value =
                end == std::string::npos || text[end] == '&' ? nullptr : value_of(text.substr(at + 1, end - at - 1));
            if (!value) {
                result_ += text[at++];
                continue;
            }
            at = end + 1;
            open_.push_back(value);
            if (!append(*value))
                return false;
            open_.pop_back();
        }
        return true;
    }

    std::string take() { return std::move(result_); }

  private:
    /// nullptr: it stays as it is, for nothing declares it, or it is within itself, or within too many others.
    const std::string *value_of(std::string_view name) const {
        constexpr std::size_t deepest = 32;
        const auto found = entities_.find(name);
        if (found == entities_.end() || open_.size() == deepest ||
            std::ranges::find(open_, &found->second) != open_.end())
            return nullptr;
        return &found->second;
    }

    const Entities &entities_;
    const std::size_t most_bytes_;
    std::size_t bytes_ = 0;
    std::string result_;
    std::vector<const std::string *> open_; ///< values that the text lies in
};

} // namespace

std::string with_entities(std::string text, std::size_t most_bytes) {
    const std::optional<DocumentType> type = document_type(text);
    if (!type)
        return text;
    Expansion expansion(type->entities, most_bytes);
    if (!expansion.append(std::string_view(text).substr(type->end)))
        return text;
    return text.substr(0, type->end) + expansion.take();
}

} // namespace gradus
