// Textures of a scene: pictures and patterns over (u, v) that stand for a parameter of a material. What they are worth
// at a point is said here in double precision; kernels/lib/texture_lookup.h says the same for the device.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gradus {

/// A picture as its file stores it. Texels lie in rows from the top left, in words of 32 bits, the first texel in the
/// lowest bits: a channel of 8 or 16 bits each for gray; for colour four of these, the last unused; or one or three
/// floats.
struct Bitmap {
    enum class Format : std::uint32_t { byte, word, half, real }; ///< byte and word: over 255 and 65535
    std::uint32_t width = 0, height = 0;
    Format format = Format::byte;
    bool is_color = false; ///< three channels, else one
    std::vector<std::uint32_t> words;
    std::string path;

    /// A stored channel as it stands: no transfer function is undone. (x, y) must be within the picture.
    double channel(std::uint32_t x, std::uint32_t y, int channel) const;
    /// Its bits.
    std::uint32_t bits(std::uint32_t x, std::uint32_t y, int channel) const;
    /// Words for so many texels.
    static std::uint64_t words_for(std::uint64_t texels, Format format, bool is_color);
    void resize(std::uint32_t new_width, std::uint32_t new_height, Format new_format, bool color);
    /// `bits` as the format stores them.
    void set(std::uint32_t x, std::uint32_t y, int channel, std::uint32_t bits);
};

struct Texture {
    enum class Kind { bitmap, checkerboard, mesh_attribute };
    enum class Wrap : std::uint32_t { repeat, mirror, clamp };
    Kind kind = Kind::bitmap;
    std::shared_ptr<const Bitmap> bitmap; ///< bitmaps only
    bool is_nearest = false;              ///< else bilinear
    bool is_srgb = false;                 ///< what is stored is sRGB and becomes linear, texel by texel; bytes only
    Wrap wrap = Wrap::repeat;
    std::optional<Wrap> wrap_v; ///< along v, where it is another one there
    Wrap wrap_along_v() const { return wrap_v.value_or(wrap); }
    /// (u, v) of the surface to that of the texture: rows of a matrix on (u, v, 1). The texture is [0, 1]^2, v down.
    std::array<float, 6> to_uv{1, 0, 0, 0, 1, 0};
    std::array<float, 3> color_0{0.4f, 0.4f, 0.4f}, color_1{0.2f, 0.2f, 0.2f}; ///< of a checkerboard
    std::array<float, 3> scale{1, 1, 1};                                       ///< what is looked up, times this
    std::string attribute;         ///< of a mesh: the name of MeshAttribute; its value at (u, v) depends on the mesh
    float lowest = 0, highest = 1; ///< what a parameter may be: the result is clamped
    std::string name;
};

/// Linear RGB, all alike where the texture is gray. Coordinates that are not finite read as 0. Of no mesh attribute.
std::array<double, 3> texture_value(const Texture &texture, double u, double v);
/// What has been looked up, scaled and clamped as the texture says.
std::array<double, 3> texture_finished(const Texture &texture, std::array<double, 3> value);

/// Of all texels, or of both colours of a checkerboard, as texture_value() has them. Of a mesh attribute all that it
/// may be within [0, 1] and its own range.
struct TextureRange {
    std::array<double, 3> mean{}, least{}, most{};
};
TextureRange texture_range(const Texture &texture);

/// Bits of a float in half precision as a number.
double half_value(std::uint32_t bits);
/// The transfer function of sRGB, in double precision: encoded to linear.
double srgb_to_linear_value(double encoded);

} // namespace gradus
