// Pixels whose rays serve the pixels around them.
#pragma once

#include "kernels/lib/vector.h"
#include "runtime/direct_light/direct_light.h"
#include "runtime/direct_light/edge_pixels.h"
#include "runtime/scene/scene.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gradus {

/// The cells, pixels and those beyond the image that filters reach, whose rays serve the edge pixels around them.
class SharedCells {
  public:
    /// Shares `budget` rays among the cells, as shared_rays() does; pixels of which a cell has none are left out.
    SharedCells(const FilmSettings &film, const EdgePixels &edges, double budget, std::uint32_t least,
                std::uint32_t most);

    std::size_t count() const { return cells_.size(); }
    std::uint32_t rays(std::size_t cell) const { return rays_[cell]; }
    /// Its column and row in the image, or beyond.
    std::array<int, 2> place(std::size_t cell) const {
        return {int(cells_[cell] % std::size_t(wide_)) - reach_, int(cells_[cell] / std::size_t(wide_)) - reach_};
    }

    /// For each pixel around a cell, the means over its first rays and over the others.
    using HalfMeans = std::array<std::array<double, 3>, 2>;
    std::size_t pixels_around() const { return taps() * taps(); }
    /// Of a cell's rays, which have their light and, one ray after the other, taps across and down.
    void means(std::size_t cell, const lib_float::rgb *light, const float *of_rays, HalfMeans *to) const;
    /// Adds them to the pixels that the cell serves.
    void add(std::size_t cell, const HalfMeans *means);

    std::vector<DirectPixel> pixels() const;

  private:
    static constexpr std::uint32_t no_sum = 0xFFFFFFFFu;

    std::size_t taps() const { return 2 * std::size_t(reach_) + 1; }
    template <class Work>
    void for_each_cell_of(std::size_t pixel, const Work &work) const;

    int reach_, width_, height_, wide_; ///< of the image, and how wide it is with what is around
    std::vector<std::size_t> cells_;    ///< by place with what is around
    std::vector<std::uint32_t> rays_;   ///< by cell
    std::vector<std::size_t> pixels_;
    std::vector<std::array<double, 6>> sums_; ///< by these: light, variance
    std::vector<std::uint32_t> sum_of_;       ///< by pixel of the image
};

} // namespace gradus
