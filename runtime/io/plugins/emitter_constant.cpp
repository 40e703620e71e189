// <emitter type="constant">: an environment of the same radiance in every direction.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_emitter_constant() {
    return {"an environment of the same radiance in every direction; one of it and `envmap` at most",
            joined({{Parameter{"radiance", Takes::emission, "1", "what arrives"}.in("W sr⁻¹ m⁻²")},
                    meaningless({"sampling_weight", "to_world", "scale_bsphere"})})};
}

Emitter emitter_constant(Properties &properties, SceneBuilder &) {
    Emitter emitter;
    emitter.kind = Emitter::Kind::constant;
    emitter.value = properties.color("radiance");
    return emitter;
}

} // namespace gradus
