// Pixel filters: what they are, and how the samples of a frame are shared among pixels.
//
// Filter importance sampling (Ernst et al. 2006) gives each pixel samples of its own, placed with the filter's density.
// Here all pixels of a frame place their sample alike within the pixel, at offset j from its center: then each sample
// serves the pixels around it too, for whose filter it is one that they might have drawn. Seen from the pixel d pixels
// further on it lies at j - d, so that it weighs f(j - d) over the density of j, which is the sum of f(j - d) over all
// d: what importance sampling gives on average over all d that might have led to j (Blackwell 1947). Weights sum up to
// 1 at any j, also those of filters with negative lobes. White noise is less by the sum of their squares: 0.32 for a
// Gaussian of half a pixel.
#pragma once

#include "runtime/scene/scene.h"

#include <cstdint>
#include <vector>

namespace gradus {

/// The filter at `x` pixels from its center along one axis; not normalised.
double filter_value(const FilmSettings &film, double x);

/// How many pixels to each side a sample counts for; 0 for a box.
std::uint32_t filter_reach(const FilmSettings &film);

/// Along one axis, as kernels/lib/filter_table.h has them; empty for a box.
struct FilterTable {
    std::vector<float> offsets; ///< of cells' borders, in pixels from the pixel's center
    /// By cell the weights at its beginning and at its end, 2 reach + 1 each: tap t is for the pixel t - reach pixels
    /// further on. Those of a cell have its share of the filter's integral. One more cell follows, filter_cells, in
    /// which a sample is its own pixel's alone.
    std::vector<float> taps;
    /// What a sample weighs on average, for each of these pixels.
    std::vector<double> mean_taps;
};
FilterTable make_filter_table(const FilmSettings &film);

} // namespace gradus
