// What is sampled for an image: its pixels, line by line, and a border around it, as far as the pixel filter reaches.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace gradus {

struct SampledArea {
    std::uint32_t width = 0, height = 0, border = 0; ///< of the image, in pixels

    std::size_t pixels() const { return std::size_t(width) * height; } ///< of the image
    std::size_t width_of_all() const { return width + 2 * std::size_t(border); }
    std::size_t pixels_of_all() const { return width_of_all() * (height + 2 * std::size_t(border)); }
    /// Of a pixel of the image its number among all.
    std::size_t number_of(std::size_t pixel) const {
        return border == 0 ? pixel : (pixel / width + border) * width_of_all() + pixel % width + border;
    }
    /// How many pixels of the image are among the first so many of all.
    std::size_t pixels_among(std::size_t first) const {
        const std::size_t line = first / width_of_all(), column = first % width_of_all();
        const auto inside = [this](std::size_t place, std::size_t size) {
            return std::min<std::size_t>(place > border ? place - border : 0, size);
        };
        const bool is_inside = line >= border && line < border + std::size_t(height);
        return inside(line, height) * width + (is_inside ? inside(column, width) : 0);
    }
};

} // namespace gradus
