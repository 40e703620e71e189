// Pictures of any format that OpenImageIO knows, as textures hold them.
#pragma once

#include "runtime/io/bitmap_reader.h"

namespace gradus {

/// read_bitmap().
ReadBitmap decode_bitmap(const OpenFile &file, const BitmapRequest &request);

} // namespace gradus
