// <texture type="scale"> (0.x): another texture, times a factor.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_texture_scale() {
    return {"another texture, times a factor, of 0.x",
            {{"scale", Takes::signed_color, "1", "the factor; less than 0 it turns a bump map over"},
             {"texture", Takes::objects, nullptr, "one"}}};
}

Texture texture_scale(Properties &properties, SceneBuilder &builder) {
    const auto nested = properties.objects("texture");
    if (nested.size() != 1)
        throw SceneError(properties.location(), "scale needs one nested texture, not " + std::to_string(nested.size()));
    Texture texture = builder.build_object<Texture>(*nested[0].element);
    const Rgb scale = properties.color("scale");
    texture.scale = {texture.scale[0] * scale.r, texture.scale[1] * scale.g, texture.scale[2] * scale.b};
    return texture;
}

} // namespace gradus
