// The sums that a gradient-domain method makes of its samples, as the reconstruction reads them.
#pragma once

#include "runtime/trace/tracer.h"
#include "runtime/wavefront/host_table.h"
#include "runtime/wavefront/sampled_area.h"
#include "solver/poisson_solver.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace gradus {

/// A table of GRADUS_GRADIENT_FILM_COLUMNS after so many samples. It is read a column at a time, where it lies.
class GradientFilm {
  public:
    /// Samples were taken frame by frame, of the border too, and of the last one perhaps only the upper rows.
    GradientFilm(const Buffer &film, const SampledArea &area, Precision precision, std::uint64_t samples)
        : table_(film, area.pixels_of_all(), precision), area_(area), frames_(samples / area.pixels_of_all()),
          more_(samples % area.pixels_of_all()) {}

    enum Layer { primal, dx, dy };
    /// Of the image; all else here is about these, by number.
    std::size_t pixels() const { return area_.pixels(); }
    std::uint64_t frames() const { return frames_; } ///< that all pixels have
    std::uint64_t samples() const { return frames_ * pixels() + pixels_with_more(primal); }
    /// The sum of a pixel's samples for one of R, G and B, and their number: of a difference to the pixel below, that
    /// of both pixels.
    double sum(Layer layer, std::uint32_t color, std::size_t pixel) const;
    /// to[i] += the sum of pixel first + i, for pixels [first, end), at most most_at_once.
    void add_sums(Layer layer, std::uint32_t color, std::size_t first, std::size_t end, double *to) const;
    double count(Layer layer, std::size_t pixel) const { return double(frames_) + (has_more(layer, pixel) ? 1 : 0); }
    /// The first pixel after this one that has another number, or whose row does not follow in the table.
    std::size_t end_of_count(Layer layer, std::size_t pixel) const {
        const std::size_t end = has_more(layer, pixel) ? pixels_with_more(layer) : pixels();
        return area_.border == 0 ? end : std::min(end, (pixel / area_.width + 1) * area_.width);
    }
    /// As add_sums(), of their squared deviations from their mean.
    void add_deviations(Layer layer, std::uint32_t color, std::size_t first, std::size_t end, double *to) const;

    static constexpr std::size_t most_at_once = 512; ///< what stays in a first-level cache

  private:
    bool has_more(Layer layer, std::size_t pixel) const { return pixel < pixels_with_more(layer); }
    /// The first so many have a sample more than the others.
    std::size_t pixels_with_more(Layer layer) const {
        const std::size_t lag = layer == dy ? area_.width_of_all() : 0; // the sample of the pixel below belongs to it
        return more_ > lag ? area_.pixels_among(more_ - lag) : 0;
    }
    /// To a pixel of the border the image has no difference, while the table has.
    bool is_outside(Layer layer, std::size_t pixel) const {
        if (area_.border == 0)
            return false;
        return (layer == dx && pixel % area_.width + 1 == area_.width) ||
               (layer == dy && pixel / area_.width + 1 == area_.height);
    }

    HostTable table_;
    SampledArea area_;     ///< which the table has rows for
    std::uint64_t frames_; ///< samples of each row
    std::uint64_t more_;   ///< rows that have one more
};

/// The film of a render, or those of the parts of its samples: of part p modulo their number, in this order.
class GradientFilms {
  public:
    /// `tracer`: whose threads read them. `halves`: the even parts and the odd ones are two halves, which may be known
    /// apart. `replicates`: the spread of the parts, more than two, tells the variance; else that of the samples does.
    explicit GradientFilms(Tracer &tracer, bool halves = false, bool replicates = false)
        : tracer_(&tracer), has_halves_(halves), has_replicates_(replicates) {}

    /// As GradientFilm has it.
    void add(const Buffer &film, const SampledArea &area, Precision precision, std::uint64_t samples) {
        films_.push_back(std::make_shared<const GradientFilm>(film, area, precision, samples));
    }

    /// Lets go of them.
    void release() { films_.clear(); }

    bool are_halves() const { return has_halves_; }
    /// One of them by itself, the same films. Its variances, of which weights are made, are those of
    /// variance_of_samples(): half of the replicates know too little.
    GradientFilms half(int number) const;
    std::size_t pixels() const { return films_.front()->pixels(); }
    std::uint64_t samples() const;
    /// Of each pixel.
    std::uint64_t frames() const;

    /// The mean of all samples, or the variance of that mean, as they are read while this is there. The mean of no
    /// sample is `of_none`.
    PlaneSource mean(GradientFilm::Layer layer, float of_none = 0) const;
    PlaneSource variance(GradientFilm::Layer layer) const;
    /// That of samples that are independent, in each half or, of two or three, in both together; 0 of but one. Of
    /// others it is mostly more than the variance.
    PlaneSource variance_of_samples(GradientFilm::Layer layer) const;
    /// Those of all layers. Means of no sample are NaN: a solver is to take them as missing.
    ImageSources images() const;
    /// The first so many have samples, the others none.
    std::size_t pixels_with_samples() const { return std::size_t(std::min<std::uint64_t>(samples(), pixels())); }

  private:
    /// Calls work(first, end) for all pixels, at most GradientFilm::most_at_once a call, of which each film has as many
    /// samples.
    void for_each_block(GradientFilm::Layer layer,
                        const std::function<void(std::size_t first, std::size_t end)> &work) const;

    Tracer *tracer_;
    std::vector<std::shared_ptr<const GradientFilm>> films_;
    bool has_halves_, has_replicates_;
};

} // namespace gradus
