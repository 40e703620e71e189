// <integrator type="path">
//   max_depth  path edges at most, -1 (no limit); rr_depth  Russian roulette from here on, 5; hide_emitters  false
#include "runtime/io/plugins/plugin.h"

namespace gradus {

RenderSettings integrator_path(Properties &properties, SceneBuilder &) {
    RenderSettings settings;
    settings.max_depth = int(properties.integer("max_depth", -1, -1, 1000000));
    settings.rr_depth = int(properties.integer("rr_depth", 5, 1, 1000000));
    settings.hide_emitters = properties.boolean("hide_emitters", false);
    properties.ignore({"strict_normals"});
    return settings;
}

} // namespace gradus
