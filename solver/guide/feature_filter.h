// A guide image by a filter of our own: the mean of a pixel's neighbours that are like it.
//
// A neighbour counts by three measures. The patches of 3 x 3 pixels around both are compared in units of what noise
// makes them differ (Buades et al. 2005; Rousselle et al. 2012 for rendered images), by channel; the variance is that
// which two halves of the samples show, smoothed over a pixel. Albedo, normal and the depth's logarithm may differ by
// so much, the one that differs most deciding (Rousselle et al. 2013). And a value counts by the inverse root of its
// variance. Weights are made from the mean of both halves and applied to each, so that the difference of the two guides
// tells how much of the noise is left.
//
// Neighbours are compared in bands of rows: a plane of distances for each neighbour in a row, which stay in the cache
// until their patches are summed.
#pragma once

#include "solver/guide/guide_smoother.h"

#include <array>

namespace gradus {

/// Differences of features that divide a neighbour's weight by e.
struct FeatureUnits {
    double albedo = 0.07, normal = 0.4, depth = 0.07;
};

class FeatureFilter {
  public:
    /// Throws Error(ExitCode::usage) for a size of 0.
    FeatureFilter(Device &device, std::uint32_t width, std::uint32_t height, Precision precision = Precision::single);

    /// Filters both halves of an image of three channels, planes as PoissonImages has them, of which the first has
    /// `share` of all samples, to `guides`. `features`: seven planes, albedo, normal and depth. Pixels with a value
    /// that is not finite take their neighbours', and give nothing.
    void run(const std::array<const Buffer *, 2> &halves, double share, const Buffer &features,
             const std::array<Buffer *, 2> &guides, const FeatureUnits &units = {});

    static constexpr std::uint32_t features = 7;

  private:
    void make_certainty(const Buffer &images, const Buffer &certainty, const std::array<const Buffer *, 2> &halves,
                        double share);

    const solver::PlaneMaker make_;
    const solver::Grid grid_;
    Kernel import_, prepare_, import_features_, distances_, gather_, export_;
    Buffer column_share_, row_share_;
    solver::GuideSmoother smoother_;
};

} // namespace gradus
