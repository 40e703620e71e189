// Parts of the samples of each pixel that have no random number in common (kernels/lib/sample_number.h): the sample at
// place p among those of its pixel is of part p modulo their number, which is a power of two.
#pragma once

#include "runtime/wavefront/session_options.h"

#include <cstdint>
#include <string>

namespace gradus {

/// Of the number of replicates, whose spread tells the variance of a mean of samples that are not independent. With
/// more of them the variance is known better, and a sequence that is cut into more pieces has more error: see
/// docs/design.md, "Samples".
constexpr int replicate_bits = 2;

/// Whether an image tells its variance.
inline bool tells_variance(const SessionOptions &options) { return options.aov && options.variance; }

/// Whether the samples are replicates: where variances are asked for, and samples not independent.
inline bool has_replicates(const SessionOptions &options) {
    return tells_variance(options) && options.sampler == SessionOptions::Sampler::sobol;
}

/// The trait TRAIT_PART_BITS: the logarithm of the number of parts. `halves`: two are needed, even and odd samples; the
/// even replicates are the one, the odd ones the other.
inline int part_bits(const SessionOptions &options, bool halves) {
    return has_replicates(options) ? replicate_bits : halves ? 1 : 0;
}

/// Of `samples` samples of each pixel those of a part.
constexpr std::uint64_t count_of_part(std::uint64_t samples, std::uint32_t part, std::uint32_t parts) {
    return (samples + parts - 1 - part) / parts;
}

/// Of `samples` samples of `pixels` pixels, taken frame by frame, those of a part.
constexpr std::uint64_t samples_of_part(std::uint64_t samples, std::uint64_t pixels, std::uint32_t part,
                                        std::uint32_t parts) {
    const std::uint64_t frames = samples / pixels, more = samples % pixels;
    return count_of_part(frames, part, parts) * pixels + (frames % parts == part ? more : 0);
}

/// What each part has of its own: the first one by the name itself.
inline std::string name_of_part(const std::string &name, std::uint32_t part) {
    return part == 0 ? name : name + '_' + std::to_string(part);
}

} // namespace gradus
