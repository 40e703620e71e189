// Where in the image the camera may see lights at all.
#pragma once

#include "runtime/scene/scene_tables.h"

#include <cstdint>

namespace gradus {

/// Pixels of the crop, from its top left: columns [left, right), rows [top, bottom).
struct PixelRectangle {
    std::uint32_t left = 0, top = 0, right = 0, bottom = 0;

    std::uint32_t width() const { return right - left; }
    std::uint32_t height() const { return bottom - top; }
    bool contains(std::int64_t x, std::int64_t y) const { return x >= left && x < right && y >= top && y < bottom; }
};

/// The least rectangle, but for a pixel or two, beyond which no camera ray meets an emitting surface. All of the crop
/// where there is an environment, which is seen between surfaces anywhere, where a light reaches behind the camera, or
/// where that is no pinhole. `film` has its crop set.
PixelRectangle lit_rectangle(const SceneTables &tables, const FilmSettings &film);

} // namespace gradus
