#include "solver/guide/feature_filter.h"

#include "kernels/shared/guide_shared.h"
#include "kernels/shared/solver_shared.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace gradus {

namespace {

/// Bands of so many pixels: their planes stay in a processor's cache, and launches cost little beside.
constexpr std::uint32_t pixels_of_band = 32768;

/// By offset and place in a line of `size`: one over how many of the three pixels around a place are inside, and around
/// its neighbour at that offset too; `stride` places a line. What a neighbour outside would have does not matter.
std::vector<double> shares_inside(std::uint32_t size, std::uint32_t stride) {
    std::vector<double> shares(std::size_t(GUIDE_WINDOW) * stride, 1);
    for (int offset = -GUIDE_RADIUS; offset <= GUIDE_RADIUS; ++offset)
        for (std::int64_t i = 0; i < size; ++i) {
            int count = 0;
            for (int d = -1; d <= 1; ++d)
                count += i + d >= 0 && i + d < size && i + offset + d >= 0 && i + offset + d < size ? 1 : 0;
            shares[std::size_t(offset + GUIDE_RADIUS) * stride + i] = 1.0 / std::max(count, 1);
        }
    return shares;
}

/// A power of two that brings depths near 1, so that the scene's unit changes no bit: the mean of their exponents.
double depth_scale(const Buffer &features, std::size_t pixels) {
    const auto mapping = features.map(Access::read);
    const float *const depths = mapping.as<float>() + (FeatureFilter::features - 1) * pixels;
    std::int64_t sum = 0, count = 0;
    for (std::size_t i = 0; i < pixels; ++i)
        if (std::isnormal(depths[i]) && depths[i] > 0) {
            sum += std::ilogb(depths[i]);
            ++count;
        }
    // Rounded down, so that an exponent more of all is one more of the mean.
    return count > 0 ? std::ldexp(1.0, -int(std::floor(double(sum) / double(count)))) : 1;
}

} // namespace

FeatureFilter::FeatureFilter(Device &device, std::uint32_t width, std::uint32_t height, Precision precision)
    : make_(device, precision), grid_(solver::guide_grid(width, height)),
      import_(solver::guide_kernel(device, precision, "guide_input", "guide_import")),
      prepare_(solver::guide_kernel(device, precision, "guide_input", "guide_prepare")),
      import_features_(solver::guide_kernel(device, precision, "guide_input", "guide_import_features")),
      distances_(solver::guide_kernel(device, precision, "guide_filter", "guide_distances")),
      gather_(solver::guide_kernel(device, precision, "guide_filter", "guide_gather")),
      export_(solver::guide_kernel(device, precision, "guide_filter", "guide_export")),
      column_share_(make_.reals("column_share", shares_inside(width, grid_.row))),
      row_share_(make_.reals("row_share", shares_inside(height, height))), smoother_(make_, grid_, 3, 1.0) {}

void FeatureFilter::make_certainty(const Buffer &images, const Buffer &certainty,
                                   const std::array<const Buffer *, 2> &halves, double share) {
    const Buffer statistics = make_.planes("statistics", grid_, GUIDE_STATISTICS);
    const Buffer smoothed = make_.planes("smoothed", grid_, GUIDE_STATISTICS);
    import_.set_real("share", share);
    import_.bind("first_half", *halves[0]);
    import_.bind("second_half", *halves[1]);
    import_.bind(images);
    import_.bind(statistics);
    grid_.launch(import_, {0, 1});
    smoother_.run(statistics, smoothed, GUIDE_STATISTICS);
    prepare_.bind(smoothed);
    prepare_.bind("valid", statistics);
    prepare_.bind(certainty);
    grid_.launch(prepare_, {0, 1});
    finish(make_.device());
    smoother_.release();
}

void FeatureFilter::run(const std::array<const Buffer *, 2> &halves, double share, const Buffer &features,
                        const std::array<Buffer *, 2> &guides, const FeatureUnits &units) {
    const Buffer images = make_.planes("images", grid_, GUIDE_IMAGES);
    const Buffer certainty = make_.planes("certainty", grid_, GUIDE_TRUST + 1);
    make_certainty(images, certainty, halves, share);

    const Buffer near_features = make_.planes("features", grid_, GUIDE_FEATURES);
    import_features_.set_real("albedo_unit", 1 / units.albedo);
    import_features_.set_real("normal_unit", 1 / units.normal);
    import_features_.set_real("depth_unit", 1 / units.depth);
    import_features_.set_real("depth_scale", depth_scale(features, std::size_t(grid_.width) * grid_.height));
    import_features_.bind("packed", features);
    import_features_.bind(near_features);
    grid_.launch(import_features_, {0, 1});

    const Buffer sums = make_.planes("sums", grid_, GUIDE_SUMS);
    const std::uint32_t rows = std::clamp(pixels_of_band / grid_.row, 1u, grid_.height);
    const std::uint32_t band_plane = (rows + 2) * grid_.row + SOLVER_MARGIN;
    const Buffer distances = make_.reals("distances", std::size_t(band_plane) * GUIDE_WINDOW);
    for (Kernel *kernel : {&distances_, &gather_}) {
        kernel->set("band_plane", band_plane);
        kernel->bind(images);
        kernel->bind(certainty);
        kernel->bind(distances);
    }
    gather_.bind(near_features);
    gather_.bind(sums);
    gather_.bind(column_share_);
    gather_.bind(row_share_);
    gather_.set("unit", 1);
    for (std::uint32_t first = 0; first < grid_.height; first += rows) {
        const std::uint32_t lines = std::min(rows, grid_.height - first);
        for (std::uint32_t down = 0; down < GUIDE_WINDOW; ++down) {
            distances_.set("down", down);
            grid_.launch(distances_, {0, 1}, lines + 2, first);
            gather_.set("down", down);
            grid_.launch(gather_, {0, 1}, lines, first);
        }
    }
    export_.bind(sums);
    export_.bind("first_guide", *guides[0]);
    export_.bind("second_guide", *guides[1]);
    grid_.launch(export_, {0, 1});
    finish(make_.device());
}

} // namespace gradus
