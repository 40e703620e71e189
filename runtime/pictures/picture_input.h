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

} // namespace gradus
