// What lies around a picture, of Mitsuba 0.x: its wrap modes zero and one.
#pragma once

#include "runtime/scene/texture.h"

#include <compare>
#include <cstdint>
#include <optional>

namespace gradus {

/// By axis: 0 or 1 beyond the first and the last texel; nothing where the picture is wrapped otherwise.
struct PictureBorder {
    std::optional<std::uint32_t> along_u, along_v;
    std::uint32_t columns() const { return along_u ? 2 : 0; } ///< that a picture gets more
    std::uint32_t rows() const { return along_v ? 2 : 0; }
    auto operator<=>(const PictureBorder &) const = default;
};

/// The picture with a texel more on both sides. With Wrap::clamp along these axes that is the same at each (u, v),
/// nearest or bilinear, as an endless border: lookups know of none. Beyond both, u decides.
Bitmap with_border(const Bitmap &picture, const PictureBorder &border);

/// The texture's coordinates as its picture, which has such a border, asks for them.
void move_within(Texture &texture, const PictureBorder &border);

} // namespace gradus
