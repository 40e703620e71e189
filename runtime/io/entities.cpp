#include "runtime/io/entities.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

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

std::string replaced(std::string text, char from, const std::string &to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
        text.replace(at, 1, to);
    return text;
}

/// What a declaration, from behind "<!ENTITY" on, puts in the place of which name.
std::optional<std::pair<std::string, std::string>> declared(std::string_view declaration) {
    Words words(declaration);
    const std::string name(words.word());
    if (const auto value = words.quoted())
        return std::pair{name, replaced(replaced(std::string(*value), '\n', " "), '\r', " ")};
    if (words.word() != "SYSTEM")
        return std::nullopt;
    const auto file = words.quoted();
    if (!file)
        return std::nullopt;
    return std::pair{name, std::string("<include ") + entity_attribute + "=\"" + name + "\" filename=\"" +
                               replaced(std::string(*file), '"', "&quot;") + "\"/>"};
}

/// Those of the <!DOCTYPE>, which ends with `end`.
std::map<std::string, std::string> entities_of(std::string_view type) {
    std::map<std::string, std::string> entities;
    constexpr std::string_view begin = "<!ENTITY";
    for (std::size_t at = 0; (at = type.find(begin, at)) != std::string_view::npos;) {
        at += begin.size();
        if (auto entity = declared(type.substr(at)))
            entities.insert(*std::move(entity));
    }
    return entities;
}

} // namespace

std::string with_entities(std::string text, std::size_t most_bytes) {
    const std::size_t type = text.find("<!DOCTYPE");
    const std::size_t end = type == std::string::npos ? type : text.find("]>", type);
    if (end == std::string::npos)
        return text;
    const auto entities = entities_of(std::string_view(text).substr(type, end - type));
    if (entities.empty())
        return text;
    std::string result = text.substr(0, end);
    for (std::size_t at = end; at < text.size();) {
        const std::size_t ampersand = std::min(text.find('&', at), text.size());
        result.append(text, at, ampersand - at);
        at = ampersand;
        if (at == text.size())
            break;
        const std::size_t semicolon = text.find(';', at);
        const auto found =
            semicolon == std::string::npos ? entities.end() : entities.find(text.substr(at + 1, semicolon - at - 1));
        if (found == entities.end()) {
            result += text[at++];
            continue;
        }
        result += found->second;
        at = semicolon + 1;
        if (result.size() > most_bytes)
            return text;
    }
    return result;
}

} // namespace gradus
