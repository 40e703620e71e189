// <emitter type="constant">: an environment of the same radiance in every direction.
//   radiance  W sr^-1 m^-2, 1
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Emitter emitter_constant(Properties &properties, SceneBuilder &) {
    Emitter emitter;
    emitter.kind = Emitter::Kind::constant;
    emitter.value = properties.color("radiance", {1, 1, 1}, ColorUse::emission);
    properties.ignore({"sampling_weight", "to_world", "scale_bsphere"});
    return emitter;
}

} // namespace gradus
