#include "runtime/io/picture_border.h"

namespace gradus {

namespace {

/// 0 or 1 as a picture of that format stores it; in sRGB, too.
std::uint32_t bits_of(std::uint32_t value, Bitmap::Format format) {
    if (value == 0)
        return 0;
    switch (format) {
    case Bitmap::Format::byte:
        return 0xffu;
    case Bitmap::Format::word:
        return 0xffffu;
    case Bitmap::Format::half:
        return 0x3c00u;
    case Bitmap::Format::real:
        break;
    }
    return 0x3f800000u;
}

} // namespace

void add_border(Texture &texture, const PictureBorder &border) {
    if (border == PictureBorder())
        return;
    const Bitmap &inner = *texture.bitmap;
    const std::uint32_t left = border.along_u ? 1 : 0, above = border.along_v ? 1 : 0;
    auto framed = std::make_shared<Bitmap>();
    framed->path = inner.path;
    framed->resize(inner.width + 2 * left, inner.height + 2 * above, inner.format, inner.is_color);
    for (std::uint32_t y = 0; y < framed->height; ++y)
        for (std::uint32_t x = 0; x < framed->width; ++x) {
            const bool is_beside = x < left || x >= left + inner.width;
            const bool is_beyond = y < above || y >= above + inner.height;
            for (int channel = 0; channel < (inner.is_color ? 3 : 1); ++channel)
                framed->set(x, y, channel,
                            is_beside   ? bits_of(*border.along_u, inner.format)
                            : is_beyond ? bits_of(*border.along_v, inner.format)
                                        : inner.bits(x - left, y - above, channel));
        }
    const auto shrink = [&](std::size_t row, std::uint32_t size) {
        for (std::size_t i = 0; i < 3; ++i)
            texture.to_uv[row + i] =
                float((double(texture.to_uv[row + i]) * size + (i == 2 ? 1.0 : 0.0)) / (double(size) + 2));
    };
    if (border.along_u)
        shrink(0, inner.width);
    if (border.along_v)
        shrink(3, inner.height);
    texture.bitmap = std::move(framed);
}

} // namespace gradus
