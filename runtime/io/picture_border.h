// What lies around a picture, of Mitsuba 0.x: its wrap modes zero and one.
#pragma once

#include "runtime/scene/texture.h"

namespace gradus {

/// By axis: 0 or 1 beyond the first and the last texel; nothing where the picture is wrapped otherwise.
struct PictureBorder {
    std::optional<std::uint32_t> along_u, along_v;
    bool operator==(const PictureBorder &) const = default;
};

/// Gives the texture a picture with a texel more on both sides. With Wrap::clamp along these axes, which the texture
/// must have, that is the same at each (u, v), nearest or bilinear, as an endless border: lookups know of none. Beyond
/// both, u decides.
void add_border(Texture &texture, const PictureBorder &border);

} // namespace gradus
