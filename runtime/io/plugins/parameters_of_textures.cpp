#include "runtime/io/plugins/parameters_of_textures.h"

namespace gradus {

void read_to_uv(Properties &properties, Texture &texture) {
    const Matrix4 map = properties.transform("to_uv");
    const double u_scale = properties.number("uscale", 1), v_scale = properties.number("vscale", 1);
    const double u_offset = properties.number("uoffset", 0), v_offset = properties.number("voffset", 0);
    texture.to_uv = {float(u_scale * map.m[0]), float(u_scale * map.m[1]), float(u_scale * map.m[3] + u_offset),
                     float(v_scale * map.m[4]), float(v_scale * map.m[5]), float(v_scale * map.m[7] + v_offset)};
}

} // namespace gradus
