// <emitter type="point">: light from one point, the same into every direction.
#include "runtime/io/plugins/parameters_of_emitters.h"
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
    const bool is_moved = properties.has("to_world");
    const Double3 position =
        is_moved ? transform_point(properties.transform("to_world"), {0, 0, 0}) : properties.point("position");
    emitter.position = place_of(properties, is_moved ? "to_world" : "position", position);
    return emitter;
}

} // namespace gradus
