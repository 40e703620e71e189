// Entities that an XML file declares for itself, which its parser leaves as they are.
#pragma once

#include <string>

namespace gradus {

/// The text with the entities that its <!DOCTYPE> declares put in their places: `&name;` becomes what
/// `<!ENTITY name "value">` says, without line breaks so that lines keep their numbers, and of
/// `<!ENTITY name SYSTEM "file">` an <include> of that file with the attribute `entity_attribute`, for it need not have
/// one root. Entities in the values of others are put in their places too, but one within itself stays as it is, and so
/// does the text where it would grow beyond `most_bytes`.
std::string with_entities(std::string text, std::size_t most_bytes);

inline constexpr const char *entity_attribute = "gradus-entity";

} // namespace gradus
