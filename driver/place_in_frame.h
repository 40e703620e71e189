// Where the pixels of an image are in their frame, as far as its file says. Images of different places may be of one
// size, and have no pixel in common.
#pragma once

#include "runtime/film/image.h"

#include <optional>
#include <string>

namespace gradus {

struct PlaceInFrame {
    std::string crop;                 ///< "X,Y,W,H", as our renders write it; empty: none
    bool is_whole = false;            ///< whether it is a whole image, as our renders without a crop are
    std::optional<PixelPlace> origin; ///< of the data window; nothing where the format has none
};

PlaceInFrame place_in_frame(const Image &image);

/// Whether both may be of one place. A crop of ours and an image at (0, 0) that another program wrote may be: many
/// programs write everything there.
bool may_be_one_place(const PlaceInFrame &one, const PlaceInFrame &other);

/// What an image is by its place, for messages: "a whole image".
std::string place_text(const PlaceInFrame &place);

} // namespace gradus
