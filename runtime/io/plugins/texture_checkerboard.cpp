// <texture type="checkerboard">: two colours in turn, four fields in [0, 1]^2.
//   color0 (0.4), color1 (0.2), to_uv; 0.x: uscale, vscale, uoffset, voffset
#include "runtime/io/plugins/parameters_of_textures.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Texture texture_checkerboard(Properties &properties, SceneBuilder &) {
    Texture texture;
    texture.kind = Texture::Kind::checkerboard;
    const Rgb first = properties.color("color0", {0.4f, 0.4f, 0.4f}, ColorUse::emission);
    const Rgb second = properties.color("color1", {0.2f, 0.2f, 0.2f}, ColorUse::emission);
    texture.color_0 = {first.r, first.g, first.b};
    texture.color_1 = {second.r, second.g, second.b};
    read_to_uv(properties, texture);
    return texture;
}

} // namespace gradus
