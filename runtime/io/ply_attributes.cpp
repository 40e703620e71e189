#include "runtime/io/ply_attributes.h"

#include <algorithm>
#include <array>

namespace gradus {

namespace {

using Names = std::array<std::string, 3>;

/// What the properties of an attribute may be called. base: its name without the prefix.
std::vector<Names> names_of(const std::string &base) {
    std::vector<Names> names;
    if (base == "color")
        names = {{"r", "g", "b"}, {"red", "green", "blue"}};
    for (const char *ends : {"xyz", "012", "123"})
        names.push_back({base + "_" + ends[0], base + "_" + ends[1], base + "_" + ends[2]});
    constexpr std::string_view color = "_color";
    if (base.ends_with(color)) {
        const std::string first = base.substr(0, base.size() - color.size());
        names.push_back({first + "_r", first + "_g", first + "_b"});
    }
    return names;
}

} // namespace

std::vector<PlyAttribute> find_ply_attributes(const std::string &prefix, const std::vector<PlyPropertyName> &properties,
                                              const std::vector<std::string> &wanted,
                                              std::optional<std::string> &error) {
    std::vector<PlyAttribute> found;
    for (const std::string &name : wanted) {
        if (!name.starts_with(prefix))
            continue;
        for (const Names &names : names_of(name.substr(prefix.size()))) {
            PlyAttribute attribute{name, {}, 1};
            for (const std::string &property : names) {
                const auto at = std::ranges::find(properties, property, &PlyPropertyName::name);
                if (at == properties.end())
                    break;
                if (at->is_list && !error)
                    error =
                        "the property \"" + property + "\" of \"" + name + "\" is a list where a number is expected";
                attribute.properties.push_back(std::size_t(at - properties.begin()));
                if (at->largest > 0 && name.ends_with("color"))
                    attribute.unit = at->largest;
            }
            if (attribute.properties.empty())
                continue;
            if (attribute.properties.size() == 2 && !error)
                error = "the attribute \"" + name + "\" has two numbers, \"" + names[0] + "\" and \"" + names[1] +
                        "\"; it needs one or three";
            found.push_back(attribute);
            break;
        }
    }
    return found;
}

} // namespace gradus
