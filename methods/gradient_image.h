// From the sums of a gradient-domain method to its image.
#pragma once

#include "methods/method.h"
#include "runtime/direct_light/direct_light.h"
#include "runtime/film/image.h"
#include "runtime/wavefront/host_table.h"
#include "solver/poisson_solver.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace gradus {

/// A table of GRADUS_GRADIENT_FILM_COLUMNS after so many samples. It is read a column at a time, where it lies.
class GradientFilm {
  public:
    /// Samples were taken frame by frame, and of the last one perhaps only the upper rows.
    GradientFilm(const Buffer &film, std::uint32_t width, std::uint32_t height, Precision precision,
                 std::uint64_t samples)
        : table_(film, std::size_t(width) * height, precision), pixels_(std::size_t(width) * height), width_(width),
          frames_(samples / pixels_), more_(samples % pixels_) {}

    enum Layer { primal, dx, dy };
    std::size_t pixels() const { return pixels_; }
    std::uint64_t frames() const { return frames_; }
    /// Writes the mean of the samples, or the variance of that mean, by pixel for one of R, G and B.
    void mean(Layer layer, std::uint32_t color, float *plane) const;
    void variance(Layer layer, std::uint32_t color, float *plane) const;

  private:
    double mean_at(int number, std::size_t pixel, double frames) const;
    /// The samples of a pixel; of a difference to the pixel below, those of both.
    double count_at(Layer layer, std::size_t pixel) const {
        return double(frames_ + (pixel + (layer == dy ? width_ : 0) < more_ ? 1 : 0));
    }

    HostTable table_;
    std::size_t pixels_, width_;
    std::uint64_t frames_; ///< samples of each pixel
    std::uint64_t more_;   ///< pixels that have one more
};

/// `whole`, the mean of all samples, with R, G and B reconstructed; with `layers` also those that they were made from.
/// What `whole` has and the primal has not is what the camera sees of lights, and `edges` know it better where they
/// are; it is added at last, as it is. alpha comes from the variances unless the options say otherwise. `film` goes
/// once it has been read, and then `film_is_read` is called, before the solver needs its memory.
Image reconstruct(PoissonSolver &solver, Image whole, std::unique_ptr<const GradientFilm> film,
                  const std::vector<DirectPixel> &edges, const RenderOptions &options, bool layers,
                  const std::function<void()> &film_is_read = {});

/// What options ask of the solver.
PoissonOptions poisson_options(const RenderOptions &options, std::uint64_t frames);

} // namespace gradus
