#include "runtime/io/plugins/plugin.h"

#include <utility>

namespace gradus {

namespace {
template <typename Result>
using Table = std::vector<std::pair<const char *, PluginFunction<Result>>>;

/// Sorts each plugin into the table of its category by what its function returns.
template <typename Result>
const Table<Result> &table() {
    static const Table<Result> entries = [] {
        Table<Result> result;
        const auto add = [&]<typename Other>(const char *name, PluginFunction<Other> function) {
            if constexpr (std::is_same_v<Other, Result>)
                result.emplace_back(name, function);
        };
#define GRADUS_PLUGIN_ENTRY(category, name) add.template operator()<category##_result>(#name, category##_##name);
        GRADUS_PLUGINS(GRADUS_PLUGIN_ENTRY)
#undef GRADUS_PLUGIN_ENTRY
        return result;
    }();
    return entries;
}
} // namespace

template <typename Result>
PluginFunction<Result> find_plugin(const std::string &name) {
    for (const auto &[known, function] : table<Result>())
        if (name == known)
            return function;
    return nullptr;
}

template PluginFunction<Material> find_plugin(const std::string &);
template PluginFunction<Emitter> find_plugin(const std::string &);
template PluginFunction<FilmSettings> find_plugin(const std::string &);
template PluginFunction<RenderSettings> find_plugin(const std::string &);
template PluginFunction<ReconstructionFilter> find_plugin(const std::string &);
template PluginFunction<Camera> find_plugin(const std::string &);
template PluginFunction<ShapeGeometry> find_plugin(const std::string &);
template PluginFunction<Texture> find_plugin(const std::string &);

std::vector<std::string> plugin_names(const std::string &category) {
    std::vector<std::string> names;
#define GRADUS_PLUGIN_NAME(plugin_category, name)                                                                      \
    if (category == #plugin_category)                                                                                  \
        names.push_back(#name);
    GRADUS_PLUGINS(GRADUS_PLUGIN_NAME)
#undef GRADUS_PLUGIN_NAME
    return names;
}

} // namespace gradus
