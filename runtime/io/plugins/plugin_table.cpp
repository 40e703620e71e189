#include "runtime/io/plugins/plugin.h"

#include <utility>

namespace gradus {

const std::vector<CataloguedPlugin> &plugin_catalogue() {
    static const std::vector<CataloguedPlugin> catalogue = {
#define GRADUS_PLUGIN_ENTRY(category, name) {#category, #name, declare_##category##_##name()},
        GRADUS_PLUGINS(GRADUS_PLUGIN_ENTRY)
#undef GRADUS_PLUGIN_ENTRY
    };
    return catalogue;
}

namespace {
template <typename Result>
using Table = std::vector<std::pair<const char *, Plugin<Result>>>;

/// Sorts each plugin into the table of its category by what its function returns.
template <typename Result>
const Table<Result> &table() {
    static const Table<Result> entries = [] {
        Table<Result> result;
        const CataloguedPlugin *catalogued = plugin_catalogue().data();
        const auto add = [&]<typename Other>(const char *name, Other (*build)(Properties &, SceneBuilder &)) {
            if constexpr (std::is_same_v<Other, Result>)
                result.emplace_back(name, Plugin<Result>{&catalogued->declaration, build});
            ++catalogued;
        };
#define GRADUS_PLUGIN_ENTRY(category, name) add(#name, category##_##name);
        GRADUS_PLUGINS(GRADUS_PLUGIN_ENTRY)
#undef GRADUS_PLUGIN_ENTRY
        return result;
    }();
    return entries;
}
} // namespace

template <typename Result>
Plugin<Result> find_plugin(const std::string &name) {
    for (const auto &[known, plugin] : table<Result>())
        if (name == known)
            return plugin;
    return {};
}

template Plugin<Material> find_plugin(const std::string &);
template Plugin<Emitter> find_plugin(const std::string &);
template Plugin<FilmSettings> find_plugin(const std::string &);
template Plugin<RenderSettings> find_plugin(const std::string &);
template Plugin<ReconstructionFilter> find_plugin(const std::string &);
template Plugin<SampleCount> find_plugin(const std::string &);
template Plugin<Camera> find_plugin(const std::string &);
template Plugin<ShapeGeometry> find_plugin(const std::string &);
template Plugin<Texture> find_plugin(const std::string &);

std::vector<std::string> plugin_names(const std::string &category) {
    std::vector<std::string> names;
    for (const CataloguedPlugin &plugin : plugin_catalogue())
        if (plugin.category == category)
            names.push_back(plugin.name);
    return names;
}

} // namespace gradus
