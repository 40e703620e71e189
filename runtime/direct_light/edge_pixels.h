// Near which pixels lights begin or end.
#pragma once

#include "runtime/direct_light/direct_rays.h"
#include "runtime/direct_light/lit_rectangle.h"
#include "runtime/scene/filter_table.h"
#include "runtime/scene/scene.h"

#include <cstddef>
#include <vector>

namespace gradus {

struct EdgePixels {
    std::vector<std::size_t> pixels;
    std::vector<float> needs; ///< of rays: by the relative variance of a pilot ray's light; positive
};

/// Pixels of the crop near which four pilot rays through each pixel see different light: near, so far as the filter
/// reaches. Beyond the `lit` ones all would see none. `film` has its crop set.
EdgePixels edge_pixels(const FilmSettings &film, const FilterTable &filter, const PixelRectangle &lit,
                       DirectRays &rays);

} // namespace gradus
