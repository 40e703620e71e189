// <emitter type="directional">: parallel light from infinitely far away.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_emitter_directional() {
    return {"parallel light from infinitely far away",
            joined({{Parameter{"direction", Takes::point, nullptr, "the way that light travels; not beside to_world"}
                         .or_else("by to_world"),
                     {"to_world", Takes::transform, nullptr, "what turns +z into the direction"},
                     Parameter{"irradiance", Takes::emission, "1", "on a plane across the direction"}.in("W m⁻²")},
                    meaningless({"sampling_weight"})})};
}

Emitter emitter_directional(Properties &properties, SceneBuilder &) {
    Emitter emitter;
    emitter.kind = Emitter::Kind::directional;
    emitter.value = properties.color("irradiance");
    if (properties.has("direction") && properties.has("to_world"))
        throw properties.error("direction", "give a directional emitter's direction or its to_world, not both");
    const Double3 direction = properties.has("direction")
                                  ? properties.point("direction")
                                  : transform_vector(properties.transform("to_world"), {0, 0, 1});
    if (!(length(direction) > 0))
        throw properties.error("direction", "the direction of a directional emitter is zero");
    emitter.direction = to_float(normalize(direction));
    return emitter;
}

} // namespace gradus
