// The plugins of scene files as tables, for readers: docs/scene-format.md holds them too.
#pragma once

#include "runtime/io/plugins/catalogue.h"

#include <string>
#include <vector>

namespace gradus {

/// Markdown, a table for each category. Of no name all plugins.
std::string plugin_tables(const std::vector<CataloguedPlugin> &catalogue, const std::vector<std::string> &names);

} // namespace gradus
