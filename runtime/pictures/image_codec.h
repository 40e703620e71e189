// Images from files, and to the bytes of files, by OpenImageIO.
#pragma once

#include "runtime/film/image.h"
#include "runtime/io/image_io.h"
#include "runtime/io/open_file.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gradus {

/// read_image(), of all but OpenEXR files.
Image decode_image(const OpenFile &file, std::uint64_t limits, WholeNumbers are);

/// The bytes that write_png() writes to `path`, which is for messages.
std::vector<unsigned char> encode_png(const Image &image, const std::string &path);

} // namespace gradus
