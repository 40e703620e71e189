// <integrator type="direct">: emitters and their first reflection, which are paths of two edges at most.
#include "runtime/io/plugins/parameters_of_integrators.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_integrator_direct() {
    return {"emitters and their first reflection, which are paths of two edges at most",
            joined({{hide_emitters_parameter()},
                    meaningless({"strict_normals", "shading_samples", "emitter_samples", "bsdf_samples"})})};
}

RenderSettings integrator_direct(Properties &properties, SceneBuilder &) {
    RenderSettings settings;
    settings.max_depth = 2;
    settings.hide_emitters = properties.boolean("hide_emitters");
    return settings;
}

} // namespace gradus
