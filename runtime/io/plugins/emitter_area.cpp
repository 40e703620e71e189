// <emitter type="area"> inside a shape: its front side emits the same radiance into every direction.
#include "runtime/io/plugins/parameters_of_emitters.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_emitter_area() {
    return {"the front of a shape emits the same radiance into every direction; in the shape, or with an id beside "
            "shapes that refer to it",
            joined({{Parameter{"radiance", Takes::textured_emission, "1", "what it emits"}.in("W sr⁻¹ m⁻²")},
                    meaningless({"sampling_weight"})})};
}

Emitter emitter_area(Properties &properties, SceneBuilder &) {
    Emitter emitter;
    emitter.kind = Emitter::Kind::area;
    const Color radiance = properties.color("radiance");
    emitter.value = radiance.texture == no_texture ? Rgb(radiance) : Rgb{1, 1, 1};
    set_texture(radiance, emitter);
    return emitter;
}

} // namespace gradus
