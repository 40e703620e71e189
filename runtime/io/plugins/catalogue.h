// The plugins that there are, with what they declare, for whoever lists them.
#pragma once

#include "runtime/io/declaration.h"

#include <string>
#include <vector>

namespace gradus {

struct CataloguedPlugin {
    std::string category, name; ///< as in <bsdf type="diffuse">; a sampler is of any type
    Declaration declaration;
};

/// By category and name.
const std::vector<CataloguedPlugin> &plugin_catalogue();
/// Names of a category's plugins, sorted.
std::vector<std::string> plugin_names(const std::string &category);

} // namespace gradus
