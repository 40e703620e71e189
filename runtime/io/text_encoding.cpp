#include "runtime/io/text_encoding.h"

#include <pugixml.hpp>

#include <algorithm>
#include <cstddef>
#include <iconv.h>
#include <utility>

namespace gradus {

namespace {

/// As iconv names it; nullptr: UTF-8.
const char *encoding_of(const std::string &text) {
    constexpr std::size_t head = 1024; // holds what an XML declaration may say
    pugi::xml_document document;
    switch (document.load_buffer(text.data(), std::min(text.size(), head), pugi::parse_minimal).encoding) {
    case pugi::encoding_utf16_le:
        return "UTF-16LE";
    case pugi::encoding_utf16_be:
        return "UTF-16BE";
    case pugi::encoding_utf32_le:
        return "UTF-32LE";
    case pugi::encoding_utf32_be:
        return "UTF-32BE";
    case pugi::encoding_latin1:
        return "ISO-8859-1";
    default:
        return nullptr;
    }
}

} // namespace

bool convert_to_utf8(std::string &text) {
    const char *const encoding = encoding_of(text);
    if (!encoding)
        return true;
    const iconv_t converter = iconv_open("UTF-8", encoding);
    if (converter == iconv_t(-1))
        return false;
    std::string converted(2 * text.size(), '\0'); // none of these grows by more
    char *from = text.data(), *to = converted.data();
    std::size_t left = text.size(), room = converted.size();
    const bool is_whole = iconv(converter, &from, &left, &to, &room) != std::size_t(-1);
    iconv_close(converter);
    if (!is_whole)
        return false;
    converted.resize(converted.size() - room);
    text = std::move(converted);
    return true;
}

} // namespace gradus
