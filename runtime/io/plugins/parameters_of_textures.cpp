#include "runtime/io/plugins/parameters_of_textures.h"

namespace gradus {

ParameterList parameters_of_coordinates() {
    return {{"to_uv", Takes::transform, nullptr, "from the surface's (u, v)"},
            Parameter{"uvscale", Takes::number, "1", "uscale and vscale where these are not given"}.of_before_2(),
            Parameter{"uscale", Takes::number, nullptr, "what u is times then"}.as("uvscale").of_before_2(),
            Parameter{"vscale", Takes::number, nullptr, "what v is times then"}.as("uvscale").of_before_2(),
            Parameter{"uoffset", Takes::number, "0", "added to u then"}.of_before_2(),
            Parameter{"voffset", Takes::number, "0", "added to v then"}.of_before_2()};
}

void read_to_uv(Properties &properties, Texture &texture) {
    const Matrix4 map = properties.transform("to_uv");
    const double both = properties.number("uvscale");
    const double u_scale = properties.has("uscale") ? properties.number("uscale") : both;
    const double v_scale = properties.has("vscale") ? properties.number("vscale") : both;
    const double u_offset = properties.number("uoffset"), v_offset = properties.number("voffset");
    texture.to_uv = {float(u_scale * map.m[0]), float(u_scale * map.m[1]), float(u_scale * map.m[3] + u_offset),
                     float(v_scale * map.m[4]), float(v_scale * map.m[5]), float(v_scale * map.m[7] + v_offset)};
}

Parameter parameter_gamma() {
    return Parameter{"gamma", Takes::number, nullptr, "1: 8 and 16 bits are linear; all else: sRGB"}.of_before_2();
}

bool is_linear_by_gamma(Properties &properties, bool otherwise) {
    if (!properties.has("gamma"))
        return otherwise;
    const double gamma = properties.number("gamma");
    if (gamma > 0 && gamma != 1)
        properties.diagnostics().warn(properties.location_of("gamma"),
                                      "a gamma other than 1 is read as the curve of sRGB");
    return gamma == 1;
}

Texture one_color(const Rgb &color, float scale) {
    Texture texture;
    texture.kind = Texture::Kind::checkerboard;
    texture.color_0 = texture.color_1 = {color.r * scale, color.g * scale, color.b * scale};
    return texture;
}

} // namespace gradus
