// The encodings that an XML file may be in.
#pragma once

#include <string>

namespace gradus {

/// Turns an XML file in UTF-16, UTF-32 or ISO-8859-1, by its first bytes or what it declares, into UTF-8, which all
/// else is taken for. False, and the text stays, where it is not what it says or this system cannot convert it.
bool convert_to_utf8(std::string &text);

} // namespace gradus
