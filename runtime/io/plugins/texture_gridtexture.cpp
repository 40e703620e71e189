// <texture type="gridtexture"> (0.x): lines around each [0, 1]^2.
#include "runtime/io/plugins/parameters_of_textures.h"
#include "runtime/io/plugins/plugin.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace gradus {

namespace {

/// The fewest texels along a unit of which a line takes a whole number, or else the number of those tried that is
/// nearest to it.
std::uint32_t texels_for(double line_width) {
    constexpr std::uint32_t most = 1000;
    constexpr double exact = 1e-6;
    std::uint32_t best = most;
    double least = 1;
    for (std::uint32_t texels = 2; texels <= most; ++texels) {
        const double line = line_width * texels, error = std::abs(line - std::round(line)) / texels;
        if (error < least - exact) {
            best = texels;
            least = error;
        }
    }
    return best;
}

/// A picture of the lines, which is looked up to its nearest texel.
std::shared_ptr<const Bitmap> picture_of_lines(double line_width, const Rgb &ground, const Rgb &lines) {
    const std::uint32_t texels = texels_for(line_width);
    const auto line = std::uint32_t(std::lround(line_width * texels));
    const auto is_line = [&](std::uint32_t i) { return i < line || i >= texels - line; };
    auto picture = std::make_shared<Bitmap>();
    picture->path = "gridtexture";
    picture->resize(texels, texels, Bitmap::Format::real, true);
    for (std::uint32_t y = 0; y < texels; ++y)
        for (std::uint32_t x = 0; x < texels; ++x) {
            const Rgb &color = is_line(x) || is_line(y) ? lines : ground;
            picture->set(x, y, 0, std::bit_cast<std::uint32_t>(color.r));
            picture->set(x, y, 1, std::bit_cast<std::uint32_t>(color.g));
            picture->set(x, y, 2, std::bit_cast<std::uint32_t>(color.b));
        }
    return picture;
}

} // namespace

Declaration declare_texture_gridtexture() {
    return {
        "lines around each [0, 1]², of 0.x",
        joined({{{"color0", Takes::color, "0.2", "between the lines"},
                 {"color1", Takes::color, "0.4", "of the lines"},
                 Parameter{"line_width", Takes::number, "0.01", "half of a line's width, to a thousandth"}.at_least(0)},
                parameters_of_coordinates()})};
}

Texture texture_gridtexture(Properties &properties, SceneBuilder &builder) {
    Texture texture;
    texture.kind = Texture::Kind::bitmap;
    texture.is_nearest = true;
    const double line_width = std::min(properties.number("line_width"), 0.5); // then there is nothing between them
    texture.bitmap = picture_of_lines(line_width, properties.color("color0"), properties.color("color1"));
    builder.count_texture_bytes(texture.bitmap->words.size(), properties.location());
    read_to_uv(properties, texture);
    return texture;
}

} // namespace gradus
