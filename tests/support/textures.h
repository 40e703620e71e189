// Textures of random texels, for tests.
#pragma once

#include "runtime/scene/texture.h"

#include <bit>
#include <memory>
#include <random>

namespace gradus::testing {

/// A picture of random texels, of all formats within [0, 1].
inline std::shared_ptr<const Bitmap> random_bitmap(std::uint32_t width, std::uint32_t height, Bitmap::Format format,
                                                   bool is_color, unsigned seed = 1) {
    auto bitmap = std::make_shared<Bitmap>();
    bitmap->resize(width, height, format, is_color);
    std::mt19937 random(seed);
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x)
            for (int c = 0; c < (is_color ? 3 : 1); ++c) {
                const std::uint32_t bits = std::uint32_t(random());
                const float real = float(bits >> 8) * 0x1p-24f;
                bitmap->set(x, y, c,
                            format == Bitmap::Format::real   ? std::bit_cast<std::uint32_t>(real)
                            : format == Bitmap::Format::half ? bits % 0x3c01 // up to 1, denormals among them
                                                             : bits);
            }
    return bitmap;
}

inline Texture random_texture(std::uint32_t width = 8, std::uint32_t height = 6,
                              Bitmap::Format format = Bitmap::Format::byte, bool is_color = true, unsigned seed = 1) {
    Texture texture;
    texture.bitmap = random_bitmap(width, height, format, is_color, seed);
    return texture;
}

} // namespace gradus::testing
