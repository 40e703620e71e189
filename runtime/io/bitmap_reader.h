// Pictures of any format that OpenImageIO knows, as textures hold them.
#pragma once

#include "runtime/io/open_file.h"
#include "runtime/scene/texture.h"

#include <cstdint>
#include <string>

namespace gradus {

struct BitmapRequest {
    bool is_linear = false; ///< the texture takes what is stored as it is (Mitsuba's `raw`)
    /// One of the file's channels instead of its colours: r, g, b, a, or the number of one; empty: as is.
    std::string channel = {};
    std::uint64_t limits = 1; ///< as in read_image()
};

struct ReadBitmap {
    Bitmap bitmap;
    bool is_srgb = false;          ///< what is stored is sRGB
    std::uint64_t not_numbers = 0; ///< NaN and infinities, which have become 0
};

/// Decodes a file: 8 bits stay 8, 16 bits 16 and half precision half precision; but 16 bits of sRGB become linear
/// floats. Gray with or without alpha has one channel, colour three; alpha is left out. Throws Error(ExitCode::image),
/// also for a file that declares more pixels than its size accounts for (read_image()).
ReadBitmap read_bitmap(const OpenFile &file, const BitmapRequest &request);

} // namespace gradus
