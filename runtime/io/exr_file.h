// OpenEXR files, by OpenEXR itself: it loads in 3 ms, and OpenImageIO with all it brings in 200, which is longer than a
// small render takes.
#pragma once

#include "runtime/film/image.h"
#include "runtime/io/exr_header.h"
#include "runtime/io/open_file.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gradus {

/// read_image() of a file that declares so much.
Image read_exr(const OpenFile &file, const ExrSize &declared, std::uint64_t limits);

/// The bytes that write_image() writes to `path`, which is for messages. Encoding into memory meets no disk, so that
/// errors of the disk are met, and named, in one place.
std::vector<unsigned char> encode_exr(const Image &image, const std::string &path);

} // namespace gradus
