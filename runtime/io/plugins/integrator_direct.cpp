// <integrator type="direct">: emitters and their first reflection, which are paths of two edges at most.
//   hide_emitters  false
#include "runtime/io/plugins/plugin.h"

namespace gradus {

RenderSettings integrator_direct(Properties &properties, SceneBuilder &) {
    RenderSettings settings;
    settings.max_depth = 2;
    settings.hide_emitters = properties.boolean("hide_emitters", false);
    properties.ignore({"strict_normals", "shading_samples", "emitter_samples", "bsdf_samples"});
    return settings;
}

} // namespace gradus
