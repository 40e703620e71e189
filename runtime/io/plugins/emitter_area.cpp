// <emitter type="area"> inside a shape: its front side emits the same radiance everywhere and into every direction.
//   radiance  W sr^-1 m^-2, 1
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Emitter emitter_area(Properties &properties, SceneBuilder &) {
    Emitter emitter;
    emitter.kind = Emitter::Kind::area;
    emitter.value = properties.color("radiance", {1, 1, 1}, ColorUse::emission);
    properties.ignore({"sampling_weight"});
    return emitter;
}

} // namespace gradus
