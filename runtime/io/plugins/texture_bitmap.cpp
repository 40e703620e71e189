// <texture type="bitmap">: a picture from a file.
//   filename; filter_type (bilinear, nearest), wrap_mode (repeat, mirror, clamp), raw (false), to_uv
//   0.x: filterType (ewa and trilinear are read as bilinear), wrapMode, wrapModeU, wrapModeV, gamma (1
//   is raw), channel (r, g, b, a), uscale, vscale, uoffset, voffset
#include "runtime/io/plugins/parameters_of_textures.h"
#include "runtime/io/plugins/plugin.h"
#include "runtime/io/text.h"

namespace gradus {

namespace {

Texture::Wrap read_wrap(Properties &properties, const char *parameter, const std::string &otherwise) {
    const std::string name = lower_case(properties.string(parameter, otherwise));
    if (name == "repeat")
        return Texture::Wrap::repeat;
    if (name == "mirror")
        return Texture::Wrap::mirror;
    if (name == "clamp")
        return Texture::Wrap::clamp;
    throw properties.error(parameter, "unknown wrap_mode \"" + name + "\" (known: repeat, mirror, clamp)");
}

bool read_is_nearest(Properties &properties) {
    const std::string name = lower_case(properties.string("filter_type", "bilinear"));
    if (name == "nearest")
        return true;
    if (name == "bilinear" || name == "trilinear" || name == "ewa") // many samples a pixel filter by themselves
        return false;
    throw properties.error("filter_type", "unknown filter_type \"" + name + "\" (known: bilinear, nearest)");
}

} // namespace

Texture texture_bitmap(Properties &properties, SceneBuilder &builder) {
    Texture texture;
    texture.kind = Texture::Kind::bitmap;
    texture.is_nearest = read_is_nearest(properties);
    const std::string of_both = properties.string("wrap_mode", "repeat");
    texture.wrap = read_wrap(properties, "wrap_mode_u", of_both);
    const Texture::Wrap along_v = read_wrap(properties, "wrap_mode_v", properties.string("wrap_mode_u", of_both));
    if (along_v != texture.wrap)
        texture.wrap_v = along_v;
    read_to_uv(properties, texture);
    bool is_raw = properties.boolean("raw", false);
    if (properties.has("gamma")) {
        const double gamma = properties.number("gamma", -1);
        is_raw = gamma == 1;
        if (gamma > 0 && gamma != 1)
            properties.diagnostics().warn(properties.location_of("gamma"),
                                          "a gamma other than 1 is read as the curve of sRGB");
    }
    std::string channel = lower_case(properties.string("channel", ""));
    channel = channel == "all" || channel == "rgb" ? "" : channel;
    properties.ignore({"format", "accel", "cache", "max_anisotropy", "mipmaps"});
    const std::filesystem::path path = builder.find_file(properties);
    texture.bitmap = builder.bitmap(path, is_raw, channel, properties.location_of("filename"), texture.is_srgb);
    return texture;
}

} // namespace gradus
