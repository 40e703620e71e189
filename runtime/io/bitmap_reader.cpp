#include "runtime/io/bitmap_reader.h"

#include "runtime/io/picture_library.h"

namespace gradus {

ReadBitmap read_bitmap(const OpenFile &file, const BitmapRequest &request) {
    return picture_library().read_bitmap(file, request);
}

} // namespace gradus
