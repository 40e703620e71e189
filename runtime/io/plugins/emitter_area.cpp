// <emitter type="area"> inside a shape: its front side emits the same radiance into every direction.
//   radiance  W sr^-1 m^-2, 1, or a texture
#include "runtime/io/plugins/parameters_of_emitters.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Emitter emitter_area(Properties &properties, SceneBuilder &) {
    Emitter emitter;
    emitter.kind = Emitter::Kind::area;
    const Color radiance = properties.textured_emission("radiance", {1, 1, 1});
    emitter.value = radiance.texture == no_texture ? Rgb(radiance) : Rgb{1, 1, 1};
    set_texture(radiance, emitter);
    properties.ignore({"sampling_weight"});
    return emitter;
}

} // namespace gradus
