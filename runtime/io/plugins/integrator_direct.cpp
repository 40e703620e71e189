// <integrator type="direct">: emitters and their first reflection, which are paths of two edges at most.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_integrator_direct() {
    return {"emitters and their first reflection, which are paths of two edges at most",
            joined({{{"hide_emitters", Takes::boolean, "false",
                      "the camera sees no emitters: its rays pass surfaces that emit, behind holes of masks too (where "
                      "Mitsuba 3.9 "
                      "shows them), but not behind glass, however thin"}},
                    meaningless({"strict_normals", "shading_samples", "emitter_samples", "bsdf_samples"})})};
}

RenderSettings integrator_direct(Properties &properties, SceneBuilder &) {
    RenderSettings settings;
    settings.max_depth = 2;
    settings.hide_emitters = properties.boolean("hide_emitters");
    return settings;
}

} // namespace gradus
