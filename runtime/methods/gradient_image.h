// From the sums of a gradient-domain method to its image.
#pragma once

#include "runtime/film/image.h"
#include "runtime/methods/direct_light.h"
#include "runtime/methods/method.h"
#include "runtime/stages/host_table.h"
#include "solver/poisson_solver.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace gradus {

/// A table of GRADUS_GRADIENT_FILM_COLUMNS after so many samples of each pixel. It is read a column at a time, where it
/// lies.
class GradientFilm {
  public:
    GradientFilm(const Buffer &film, std::size_t pixels, Precision precision, std::uint64_t frames)
        : table_(film, pixels, precision), pixels_(pixels), frames_(frames) {}

    enum Layer { primal, dx, dy };
    std::size_t pixels() const { return pixels_; }
    std::uint64_t frames() const { return frames_; }
    /// Writes the mean of the samples, or the variance of that mean, by pixel for one of R, G and B.
    void mean(Layer layer, std::uint32_t color, float *plane) const;
    void variance(Layer layer, std::uint32_t color, float *plane) const;

  private:
    double mean_at(int number, std::size_t pixel, double frames) const;

    HostTable table_;
    std::size_t pixels_;
    std::uint64_t frames_;
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
