// What the camera sees of lights where their edges cross pixels. There a few samples leave far more error than all else
// in the image: a lamp is a hundred times brighter than what it lights.
#pragma once

#include "runtime/scene/scene_tables.h"
#include "runtime/trace/tracer.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gradus {

/// The light that the camera sees through a pixel, averaged over the pixel filter.
struct DirectPixel {
    std::size_t pixel = 0; ///< of the crop, line by line
    std::array<float, 3> light{};
    /// Of `light`, as its rays' first half and their second tell: these are one sequence, so rather more than in truth.
    std::array<float, 3> variance{};
};

/// Finds the pixels in whose reach lights begin or end, by four rays through each that may see one (lit_rectangle.h),
/// which count for nothing else, and samples those anew: one ray for each of `samples` of all pixels of the image is
/// shared among them, by how much their light varies beside what it is, and none gets more than is enough. Those that
/// would not get twice `samples` are left out. The estimates are unbiased, and so are those of the path tracer for the
/// other pixels. `film` has its crop set. Adds the rays that were traced to `rays`.
std::vector<DirectPixel> sample_direct_edges(const SceneTables &tables, const FilmSettings &film, Tracer &tracer,
                                             std::uint64_t seed, std::uint32_t samples, std::uint64_t &rays);

} // namespace gradus
