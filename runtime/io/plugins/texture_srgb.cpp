// <texture type="srgb"> or <spectrum type="srgb">: a colour.
#include "runtime/io/plugins/parameters_of_textures.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_texture_srgb() {
    return {"a colour; also as `<spectrum>`", {{"color", Takes::color, "1", "it, linear in `<rgb>`"}}};
}

Texture texture_srgb(Properties &properties, SceneBuilder &) { return one_color(properties.color("color")); }

} // namespace gradus
