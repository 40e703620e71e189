// The sums that a gradient-domain method makes of its samples, as the reconstruction reads them.
#pragma once

#include "runtime/wavefront/host_table.h"
#include "solver/poisson_solver.h"

#include <cstdint>
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
    std::uint64_t samples() const { return frames_ * pixels_ + more_; }
    /// The sum of a pixel's samples for one of R, G and B, and their number: of a difference to the pixel below, that
    /// of both pixels.
    double sum(Layer layer, std::uint32_t color, std::size_t pixel) const;
    double count(Layer layer, std::size_t pixel) const {
        return double(frames_ + (pixel + (layer == dy ? width_ : 0) < more_ ? 1 : 0));
    }
    /// The variance of their mean; 0 where there is but one.
    double variance(Layer layer, std::uint32_t color, std::size_t pixel) const;

  private:
    HostTable table_;
    std::size_t pixels_, width_;
    std::uint64_t frames_; ///< samples of each pixel
    std::uint64_t more_;   ///< pixels that have one more
};

/// The film of a render, or those of its halves.
class GradientFilms {
  public:
    /// As GradientFilm has it.
    void add(const Buffer &film, std::uint32_t width, std::uint32_t height, Precision precision,
             std::uint64_t samples) {
        films_.push_back(std::make_shared<const GradientFilm>(film, width, height, precision, samples));
    }

    bool are_halves() const { return films_.size() == 2; }
    /// One of them by itself, the same film.
    GradientFilms half(int number) const;
    std::size_t pixels() const { return films_.front()->pixels(); }
    std::uint64_t samples() const;
    /// Of each pixel.
    std::uint64_t frames() const { return samples() / pixels(); }

    /// The mean of all samples, or the variance of that mean, as they are read while this is there.
    PlaneSource mean(GradientFilm::Layer layer) const;
    PlaneSource variance(GradientFilm::Layer layer) const;
    /// Those of all layers.
    ImageSources images() const;

  private:
    std::vector<std::shared_ptr<const GradientFilm>> films_;
};

} // namespace gradus
