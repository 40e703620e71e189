// What an image may hold in a file.
#pragma once

#include "runtime/film/image.h"

#include <cstdint>

namespace gradus {

/// Values that are NaN or infinite, and pixels that have some.
struct NonFinite {
    std::uint64_t values = 0, pixels = 0;
};

/// Those become 0: they have no place in a file, for what reads it spreads them. Returns how many there were.
NonFinite settle_values(Image &image);

} // namespace gradus
