// <texture type="d65"> or <spectrum type="d65">: the white of daylight, which is (1, 1, 1) in the RGB of a scene.
#include "runtime/io/plugins/parameters_of_textures.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_texture_d65() {
    return {"the white of daylight, which in RGB is 1; also as `<spectrum>`",
            {{"color", Takes::color, "1", "its tint"}, Parameter{"scale", Takes::number, "1", "a factor"}.at_least(0)}};
}

Texture texture_d65(Properties &properties, SceneBuilder &) {
    return one_color(properties.color("color"), float(properties.number("scale")));
}

} // namespace gradus
