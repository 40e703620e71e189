// Small images for tests.
#pragma once

#include "runtime/film/image.h"

#include <string>
#include <utility>
#include <vector>

namespace gradus {

/// One row of pixels, or `height` of them, with the channels given.
inline Image make_image(std::uint32_t width, std::uint32_t height,
                        const std::vector<std::pair<std::string, std::vector<float>>> &channels) {
    Image image;
    image.width = width;
    image.height = height;
    for (const auto &[name, values] : channels)
        image.channels.push_back({name, values});
    return image;
}

/// R, G and B of the same values.
inline Image make_gray(std::uint32_t width, std::uint32_t height, const std::vector<float> &values) {
    return make_image(width, height, {{"R", values}, {"G", values}, {"B", values}});
}

} // namespace gradus
