#include "runtime/io/declaration.h"

#include <algorithm>

namespace gradus {

ParameterList joined(std::initializer_list<ParameterList> lists) {
    ParameterList all;
    for (const ParameterList &list : lists)
        all.insert(all.end(), list.begin(), list.end());
    return all;
}

ParameterList meaningless(std::initializer_list<const char *> names) {
    ParameterList list;
    for (const char *name : names)
        list.push_back({name, Takes::nothing});
    return list;
}

const Parameter *Declaration::find(const std::string &name) const {
    const auto found = std::ranges::find_if(parameters, [&](const Parameter &parameter) {
        return parameter.name == name && parameter.takes != Takes::objects;
    });
    return found == parameters.end() ? nullptr : &*found;
}

const Parameter *Declaration::find_objects(const std::string &tag) const {
    const auto found = std::ranges::find_if(parameters, [&](const Parameter &parameter) {
        return parameter.name == tag && parameter.takes == Takes::objects;
    });
    return found == parameters.end() ? nullptr : &*found;
}

} // namespace gradus
