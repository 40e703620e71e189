// Of a filter with negative lobes, what the samples of a frame weigh. All pixels share their place within the pixel
// (TRAIT_SHARED_JITTER) and so the weight, so that its mean over the frames, which tends to 1, is a factor of the whole
// image: after 16 frames of Lanczos's filter off by a third. So sums go over the weights' sum and not over the number
// of frames, as those of a film that adds samples to the pixels around do.
#pragma once

#include "runtime/wavefront/sample_weights.h"
#include "runtime/wavefront/session.h"

#include <cstdint>
#include <vector>

namespace gradus {

class SharedWeights {
  public:
    /// Reads the scene's tables, which must live as long.
    explicit SharedWeights(const Session &session);

    /// Frames are those from this number on; from 0 at first.
    void begin_at(std::uint64_t first_frame);

    /// Whether frames weigh other than 1.
    bool are_there() const { return are_there_; }
    /// The weights of the frames of a part among the first `frames` ones, and their squares, summed: both the number of
    /// these frames where they weigh 1. `parts` divides the number of parts that the samples have.
    struct Sums {
        double weights = 0, squares = 0;
    };
    Sums sums(std::uint64_t frames, std::uint32_t part, std::uint32_t parts) const;
    /// The sum of weights that a mean is over: at least least_share of the number of frames, for few frames may have
    /// weights that cancel out, which tells no brightness.
    double of_part(std::uint64_t frames, std::uint32_t part, std::uint32_t parts) const;
    /// What those frames weigh for a mean and its variance.
    SampleWeights of_samples(std::uint64_t frames, std::uint32_t part, std::uint32_t parts) const;

    /// Where the sequence of places is to start, of many starts: the number `shared_start` of kernels. 0 where frames
    /// weigh 1; else one with which few frames, and few of each part, do not cancel out. It depends on the seed alone.
    std::uint32_t chosen_start() const;

  private:
    /// Of a frame, counted from the first.
    double weight(std::uint64_t frame, std::uint32_t start) const;

    const Session &session_;
    bool are_there_;
    std::uint64_t first_frame_ = 0;
    mutable std::vector<Sums> sums_; ///< of a frame and those of its part before, as far as they have been asked for
};

} // namespace gradus
