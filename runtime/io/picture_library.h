// What is done by OpenImageIO. It brings 260 libraries, which take 0.2 s to load, so it is linked to a library of its
// own (runtime/pictures) that is loaded where such files are read or written: all but images of OpenEXR (exr_file.h).
#pragma once

#include "runtime/film/image.h"
#include "runtime/io/bitmap_reader.h"
#include "runtime/io/image_io.h"
#include "runtime/io/open_file.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gradus {

/// The files' names are for messages.
struct PictureLibrary {
    const char *version; ///< the project's: what was built with another one does not know these functions
    /// As image_io.h has it, of all but OpenEXR files.
    Image (*read_image)(const OpenFile &file, std::uint64_t limits, WholeNumbers are);
    ReadBitmap (*read_bitmap)(const OpenFile &file, const BitmapRequest &request);     ///< as bitmap_reader.h has it
    std::vector<unsigned char> (*png_of)(const Image &image, const std::string &path); ///< what write_png() writes
};

/// Loads it at first use: the file gradus-pictures.so, or $GRADUS_PICTURES. Throws Error(ExitCode::failure) where it
/// cannot be loaded, or is of another version, and Error(ExitCode::device) where there is no memory for it.
const PictureLibrary &picture_library();

} // namespace gradus
