#include "runtime/io/plugins/parameters_of_textures.h"

namespace gradus {

ParameterList parameters_of_coordinates() {
    return {{"to_uv", Takes::transform, nullptr, "from the surface's (u, v)"},
            Parameter{"uscale", Takes::number, "1", "what u is times then"}.of_before_2(),
            Parameter{"vscale", Takes::number, "1", "what v is times then"}.of_before_2(),
            Parameter{"uoffset", Takes::number, "0", "added to u then"}.of_before_2(),
            Parameter{"voffset", Takes::number, "0", "added to v then"}.of_before_2()};
}

void read_to_uv(Properties &properties, Texture &texture) {
    const Matrix4 map = properties.transform("to_uv");
    const double u_scale = properties.number("uscale"), v_scale = properties.number("vscale");
    const double u_offset = properties.number("uoffset"), v_offset = properties.number("voffset");
    texture.to_uv = {float(u_scale * map.m[0]), float(u_scale * map.m[1]), float(u_scale * map.m[3] + u_offset),
                     float(v_scale * map.m[4]), float(v_scale * map.m[5]), float(v_scale * map.m[7] + v_offset)};
}

Texture one_color(const Rgb &color, float scale) {
    Texture texture;
    texture.kind = Texture::Kind::checkerboard;
    texture.color_0 = texture.color_1 = {color.r * scale, color.g * scale, color.b * scale};
    return texture;
}

} // namespace gradus
