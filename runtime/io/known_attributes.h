// The attributes that elements of a scene file may have.
#pragma once

#include <span>
#include <string_view>

namespace gradus {

/// Of an element with that tag, in any of the dialects; nullptr of tags that no scene file has. All may have an id and
/// a name beside these.
const std::span<const std::string_view> *known_attributes(std::string_view tag);

} // namespace gradus
