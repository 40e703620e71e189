// <integrator type="path">
#include "runtime/io/plugins/parameters_of_integrators.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_integrator_path() {
    return {"paths of any length",
            joined({{Parameter{"max_depth", Takes::integer, "-1", "edges of a path at most; −1: no limit"}
                         .at_least(-1)
                         .at_most(1000000),
                     Parameter{"rr_depth", Takes::integer, "5", "Russian roulette from here on"}
                         .in("edges")
                         .at_least(1)
                         .at_most(1000000),
                     hide_emitters_parameter()},
                    meaningless({"strict_normals", "samples_per_pass", "block_size", "timeout"})})};
}

RenderSettings integrator_path(Properties &properties, SceneBuilder &) {
    RenderSettings settings;
    settings.max_depth = int(properties.integer("max_depth"));
    if (settings.max_depth == 0)
        properties.diagnostics().warn(properties.location_of("max_depth"),
                                      "max_depth 0 leaves no path: the image will be black");
    settings.rr_depth = int(properties.integer("rr_depth"));
    settings.hide_emitters = properties.boolean("hide_emitters");
    return settings;
}

} // namespace gradus
