// <texture type="checkerboard">: two colours in turn, four fields in [0, 1]^2.
#include "runtime/io/plugins/parameters_of_textures.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_texture_checkerboard() {
    return {"two colours in turn, four fields in [0, 1]²",
            joined({{{"color0", Takes::color, "0.4", "where both halves are alike"},
                     {"color1", Takes::color, "0.2", "of the others"}},
                    parameters_of_coordinates()})};
}

Texture texture_checkerboard(Properties &properties, SceneBuilder &) {
    Texture texture;
    texture.kind = Texture::Kind::checkerboard;
    const Rgb first = properties.color("color0");
    const Rgb second = properties.color("color1");
    texture.color_0 = {first.r, first.g, first.b};
    texture.color_1 = {second.r, second.g, second.b};
    read_to_uv(properties, texture);
    return texture;
}

} // namespace gradus
