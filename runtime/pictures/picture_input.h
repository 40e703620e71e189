// Opens pictures by OpenImageIO.
#pragma once

#include "runtime/io/open_file.h"

#include <OpenImageIO/imageio.h>

#include <cstdint>
#include <memory>
#include <string>

namespace gradus {

/// That are coded and decoded at a time: several of OpenEXR's blocks of 16 for each thread.
constexpr int rows_at_a_time = 128;

struct PictureInput {
    std::unique_ptr<OIIO::ImageInput> input; ///< nullptr: see error
    std::string error;
};

/// Any format that OpenImageIO knows. Of confined files those whose readers open no file but the one: playlists of
/// films, say, name others. Colours are as they are stored, not times alpha.
PictureInput open_picture(const OpenFile &file);

/// Bytes of pixels that may be read of a file, as read_image() says it: a few kilobytes can declare any number.
std::uint64_t most_pixel_bytes(const OpenFile &file, std::uint64_t limits);

/// The library's words about a file, which call it by its name.
std::string named_in(std::string message, const OpenFile &file);

} // namespace gradus
