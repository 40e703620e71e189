// <emitter type="directional">: parallel light from infinitely far away.
//   direction, the way that light travels, or to_world applied to +z; irradiance on a plane across it  W m^-2, 1
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Emitter emitter_directional(Properties &properties, SceneBuilder &) {
    Emitter emitter;
    emitter.kind = Emitter::Kind::directional;
    emitter.value = properties.color("irradiance", {1, 1, 1}, ColorUse::emission);
    if (properties.has("direction") && properties.has("to_world"))
        throw properties.error("direction", "give a directional emitter's direction or its to_world, not both");
    const Double3 direction = properties.has("direction")
                                  ? properties.point("direction", {0, 0, 1})
                                  : transform_vector(properties.transform("to_world"), {0, 0, 1});
    if (!(length(direction) > 0))
        throw properties.error("direction", "the direction of a directional emitter is zero");
    emitter.direction = to_float(normalize(direction));
    properties.ignore({"sampling_weight"});
    return emitter;
}

} // namespace gradus
