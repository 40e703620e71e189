// An image of named float channels with metadata, as the film gives it and image files hold it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gradus {

/// One plane of an image: width * height floats, row by row from the top left.
struct Channel {
    std::string name; ///< "R", "G", "B", or "layer.R" as OpenEXR names layers
    std::vector<float> values;
};

/// Where a pixel is in a frame, which may begin anywhere.
struct PixelPlace {
    std::int32_t x = 0, y = 0; ///< to the right and down
    bool operator==(const PixelPlace &) const = default;
};

struct Image {
    std::uint32_t width = 0, height = 0;
    std::vector<Channel> channels;
    std::map<std::string, std::string> metadata;
    std::optional<PixelPlace> origin = {}; ///< of the first pixel, where a file says it

    /// The channel of that name, or nullptr.
    const Channel *find(const std::string &name) const {
        for (const Channel &channel : channels)
            if (channel.name == name)
                return &channel;
        return nullptr;
    }
};

} // namespace gradus
