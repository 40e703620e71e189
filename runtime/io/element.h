// The tree of a scene file after everything textual is done: includes spliced in, $parameters replaced.
#pragma once

#include "runtime/io/location.h"

#include <string>
#include <utility>
#include <vector>

namespace gradus {

struct Element {
    std::string tag; ///< "bsdf", "float", "transform", "lookat"...
    std::vector<std::pair<std::string, std::string>> attributes;
    std::vector<Element> children;
    Location location;
    int version = 3; ///< first number of the version of the file it stands in

    /// The attribute's value, or nullptr.
    const std::string *attribute(const std::string &name) const {
        for (const auto &[key, value] : attributes)
            if (key == name)
                return &value;
        return nullptr;
    }
    std::string attribute_or(const std::string &name, const std::string &otherwise) const {
        const std::string *value = attribute(name);
        return value ? *value : otherwise;
    }
    /// Files of version 0.x, written in camelCase, mean some things in another way.
    bool is_legacy() const { return version < 2; }
};

} // namespace gradus
