// <emitter type="point">: light from one point, the same into every direction.
//   position, or to_world applied to the origin; intensity  W sr^-1, 1
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Emitter emitter_point(Properties &properties, SceneBuilder &) {
    Emitter emitter;
    emitter.kind = Emitter::Kind::point;
    emitter.value = properties.color("intensity", {1, 1, 1}, ColorUse::emission);
    if (properties.has("position") && properties.has("to_world"))
        throw properties.error("position", "give a point emitter's position or its to_world, not both");
    const Double3 position = properties.has("to_world") ? transform_point(properties.transform("to_world"), {0, 0, 0})
                                                        : properties.point("position", {0, 0, 0});
    emitter.position = to_float(position);
    properties.ignore({"sampling_weight"});
    return emitter;
}

} // namespace gradus
