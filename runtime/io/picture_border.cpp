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

Bitmap with_border(const Bitmap &picture, const PictureBorder &border) {
    const std::uint32_t left = border.columns() / 2, above = border.rows() / 2;
    Bitmap framed;
    framed.path = picture.path;
    framed.resize(picture.width + border.columns(), picture.height + border.rows(), picture.format, picture.is_color);
    for (std::uint32_t y = 0; y < framed.height; ++y)
        for (std::uint32_t x = 0; x < framed.width; ++x) {
            const bool is_beside = x < left || x >= left + picture.width;
            const bool is_beyond = y < above || y >= above + picture.height;
            for (int channel = 0; channel < (picture.is_color ? 3 : 1); ++channel)
                framed.set(x, y, channel,
                           is_beside   ? bits_of(*border.along_u, picture.format)
                           : is_beyond ? bits_of(*border.along_v, picture.format)
                                       : picture.bits(x - left, y - above, channel));
        }
    return framed;
}

void move_within(Texture &texture, const PictureBorder &border) {
    const auto shrink = [&](std::size_t row, std::uint32_t size) { // of the picture with its border
        for (std::size_t i = 0; i < 3; ++i)
            texture.to_uv[row + i] =
                float((double(texture.to_uv[row + i]) * (size - 2.0) + (i == 2 ? 1.0 : 0.0)) / double(size));
    };
    if (border.along_u)
        shrink(0, texture.bitmap->width);
    if (border.along_v)
        shrink(3, texture.bitmap->height);
}

} // namespace gradus
