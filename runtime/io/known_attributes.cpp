#include "runtime/io/known_attributes.h"

#include "runtime/io/properties.h"
#include "runtime/io/text.h"

#include <string>
#include <unordered_map>

namespace gradus {

namespace {

using Names = std::span<const std::string_view>;

constexpr std::string_view of_scene[] = {"version"}, of_object[] = {"type", "version"}, of_value[] = {"value"},
                           of_file[] = {"filename"}, of_alias[] = {"as"}, of_color[] = {"value", "intent"},
                           of_spectrum[] = {"value", "intent", "filename", "type"},
                           of_black_body[] = {"temperature", "scale"}, of_transform[] = {"time"},
                           of_look_at[] = {"origin", "target", "up"}, of_triple[] = {"value", "x", "y", "z"},
                           of_rotation[] = {"value", "x", "y", "z", "angle"};

std::unordered_map<std::string, Names> names_by_tag() {
    std::unordered_map<std::string, Names> names;
    for (const std::string &tag : all_tags())
        names[tag] = is_object_tag(tag) ? Names(of_object) : Names(of_value);
    for (const char *tag : {"point", "vector", "translate", "scale"})
        names[tag] = of_triple;
    for (const char *tag : {"rgb", "srgb"})
        names[tag] = of_color;
    for (const char *tag : {"default", "path", "matrix"})
        names[tag] = of_value;
    names["spectrum"] = of_spectrum;
    names["blackbody"] = of_black_body;
    names["transform"] = of_transform;
    names["lookat"] = of_look_at;
    names["rotate"] = of_rotation;
    names["scene"] = of_scene;
    names["include"] = of_file;
    names["alias"] = of_alias;
    names["ref"] = names["animation"] = {};
    return names;
}

} // namespace

const Names *known_attributes(std::string_view tag) {
    static const std::unordered_map<std::string, Names> names = names_by_tag();
    const auto found = names.find(lower_case(tag)); // 0.x has lookAt
    return found == names.end() ? nullptr : &found->second;
}

} // namespace gradus
