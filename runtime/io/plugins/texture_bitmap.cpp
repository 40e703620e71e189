// <texture type="bitmap">: a picture from a file.
#include "runtime/io/plugins/parameters_of_textures.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

namespace {

struct FoundWrap {
    Texture::Wrap wrap;
    std::optional<std::uint32_t> border; ///< what is there instead
};

FoundWrap read_wrap(Properties &properties, const char *parameter) {
    const std::string name = properties.choice(parameter);
    if (name == "repeat" || name == "mirror")
        return {name == "repeat" ? Texture::Wrap::repeat : Texture::Wrap::mirror, std::nullopt};
    if (name == "clamp")
        return {Texture::Wrap::clamp, std::nullopt};
    return {Texture::Wrap::clamp, name == "one" || name == "white" ? 1u : 0u};
}

} // namespace

Declaration declare_texture_bitmap() {
    const std::vector<std::string> wraps = {"repeat", "mirror", "clamp", "zero", "one", "black", "white"};
    return {
        "a picture from a file: 8 and 16 bits, half and single precision; one channel or three, alpha left out",
        joined({{Parameter{"filename", Takes::filename, nullptr,
                           "PNG, JPEG, TGA, EXR, HDR and what else OpenImageIO reads"}
                     .required(),
                 Parameter{"filter_type", Takes::choice, "bilinear",
                           "between texels; trilinear, ewa and anisotropic are read as bilinear"}
                     .of({"bilinear", "nearest", "trilinear", "ewa", "anisotropic"}),
                 Parameter{"wrap_mode", Takes::choice, "repeat",
                           "beyond [0, 1]²; zero and black, one and white are of 0.x"}
                     .of(wraps),
                 Parameter{"wrap_mode_u", Takes::choice, nullptr, "along u"}.as("wrap_mode").of(wraps).of_before_2(),
                 Parameter{"wrap_mode_v", Takes::choice, nullptr, "along v"}.as("wrap_mode_u").of(wraps).of_before_2(),
                 {"raw", Takes::boolean, "false", "8 and 16 bits are linear, not sRGB; X, Y and Z are read, too"},
                 parameter_gamma().or_else("by raw"),
                 Parameter{"channel", Takes::choice, "all", "that one alone"}
                     .of({"all", "rgb", "r", "g", "b", "a"})
                     .of_before_2()},
                parameters_of_coordinates(),
                meaningless({"format", "accel", "cache", "max_anisotropy", "mipmaps"})})};
}

Picture read_picture(Properties &properties, SceneBuilder &builder) {
    Picture picture;
    picture.is_linear = is_linear_by_gamma(properties, properties.boolean("raw"));
    const std::string channel = properties.choice("channel");
    picture.channel = channel == "all" || channel == "rgb" ? "" : channel;
    picture.path = builder.find_file(properties);
    return picture;
}

Texture texture_bitmap(Properties &properties, SceneBuilder &builder) {
    Texture texture;
    texture.kind = Texture::Kind::bitmap;
    texture.is_nearest = properties.choice("filter_type") == "nearest"; // many samples a pixel filter by themselves
    const FoundWrap along_u = read_wrap(properties, "wrap_mode_u"), along_v = read_wrap(properties, "wrap_mode_v");
    texture.wrap = along_u.wrap;
    if (along_v.wrap != along_u.wrap)
        texture.wrap_v = along_v.wrap;
    read_to_uv(properties, texture);
    texture.bitmap =
        builder.bitmap(read_picture(properties, builder), properties.location_of("filename"), texture.is_srgb);
    const PictureBorder border{along_u.border, along_v.border};
    texture.bitmap = builder.bordered(texture.bitmap, border, properties.location_of("filename"));
    move_within(texture, border);
    return texture;
}

} // namespace gradus
