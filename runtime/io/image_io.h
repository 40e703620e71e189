// Image files in and out.
#pragma once

#include "runtime/film/image.h"
#include "runtime/io/open_file.h"

#include <cstdint>
#include <string>

namespace gradus {

/// What colours of 8 and 16 bits are; as_told: what their file says, and sRGB where it says nothing of 8 bits.
enum class WholeNumbers { as_told, srgb, linear };

/// Reads an OpenEXR file, or an image of any other format that OpenImageIO knows, all channels as float, row by row
/// from the top left. Channels keep their names ("R", "layer.R"); their order is the file's, so look them up by name.
/// Colour channels of formats that hold sRGB values (PNG, JPEG) are decoded to linear. Parts of a file after the first
/// have their channel names led by "NAME." with the part's name. Metadata that write_image() wrote is read back under
/// the same keys; other attributes, of OpenEXR files texts and numbers, keep their names. OpenEXR files say where their
/// first pixel is in its frame; all parts of a file must begin there. What the file declares is checked before anything
/// is allocated: at most `limits` times 1024 channels and 256 MiB of pixels as floats, to which 64 times the file's
/// size comes. Throws Error(ExitCode::image).
Image read_image(const std::string &path, std::uint64_t limits = 1);
Image read_image(const OpenFile &file, std::uint64_t limits = 1, WholeNumbers are = WholeNumbers::as_told);

/// Writes all channels as 32-bit float to an OpenEXR file, zipped where that makes it smaller by a seventh, with the
/// metadata as string attributes "gradus:KEY" and the first pixel at `origin`. Infinities and NaN are kept. The file is
/// written in whole or not at all (write_file_atomically). Equal images give equal bytes. Throws
/// Error(ExitCode::output).
void write_image(const Image &image, const std::string &path);

/// Writes R, G, B as an 8-bit PNG as tonemap.h says. Throws Error(ExitCode::output), or Error(ExitCode::image) where a
/// channel is missing.
void write_png(const Image &image, const std::string &path);

} // namespace gradus
