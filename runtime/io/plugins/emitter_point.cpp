// <emitter type="point">: light from one point, the same into every direction.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_emitter_point() {
    return {"light from one point, the same into every direction",
            joined({{Parameter{"position", Takes::point, "0 0 0", "where it is; not beside to_world"}.in("lengths"),
                     {"to_world", Takes::transform, nullptr, "what moves the origin there"},
                     Parameter{"intensity", Takes::emission, "1", "what it emits"}.in("W sr⁻¹")},
                    meaningless({"sampling_weight"})})};
}

Emitter emitter_point(Properties &properties, SceneBuilder &) {
    Emitter emitter;
    emitter.kind = Emitter::Kind::point;
    emitter.value = properties.color("intensity");
    if (properties.has("position") && properties.has("to_world"))
        throw properties.error("position", "give a point emitter's position or its to_world, not both");
    const Double3 position = properties.has("to_world") ? transform_point(properties.transform("to_world"), {0, 0, 0})
                                                        : properties.point("position");
    emitter.position = to_float(position);
    return emitter;
}

} // namespace gradus
