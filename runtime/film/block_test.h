// Is an estimator unbiased? Images of independent seeds against a reference, block by block.
#pragma once

#include "runtime/film/image.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace gradus {

/// z scores of the blocks of an image, each of its channels apart.
struct BlockTest {
    std::uint32_t blocks_x = 0, blocks_y = 0;
    std::vector<std::string> channels;
    /// channels * blocks_y * blocks_x scores, channel by channel, row by row. NaN: the block was left out, for a
    /// value that is not finite, or because nothing varies there and both means are equal up to rounding.
    std::vector<double> z;
    std::vector<double> difference;     ///< mean of ours minus the reference's, same order
    std::vector<double> standard_error; ///< of the difference, same order

    std::size_t tested = 0;     ///< scores that are not NaN
    std::size_t non_finite = 0; ///< blocks left out for a value that is not finite
    double largest = 0;         ///< largest |z|
    std::size_t largest_index = 0;
    std::size_t over_three = 0;       ///< how many |z| exceed 3
    double expected_over_three = 0;   ///< as chance has it
    std::size_t over_three_limit = 0; ///< more than that happens to an unbiased estimator once in a thousand tests
    double largest_limit = 0;         ///< a larger |z| happens to an unbiased one once in a thousand tests (Sidak)

    /// True where something was tested, all of it was finite, and both limits hold.
    bool passed() const {
        return tested > 0 && non_finite == 0 && largest <= largest_limit && over_three <= over_three_limit;
    }
};

/// Tests whether the mean of `seeds`, images of independent seeds and of `seed_spp` samples a pixel each, equals the
/// reference: z = (mean of ours - reference) / sqrt(variance of our mean + variance of the reference), both for the
/// mean over each block of `block` x `block` pixels (smaller at the right and bottom edge); block 0: the whole image
/// is one block, block 1: each pixel.
///
/// `reference_variance` holds the variance of the reference's mean by pixel, pixels independent (box filter), from
/// `reference_spp` samples a pixel; without channels: unknown, taken as 0. The variance of our mean is the sample
/// variance over the seeds over their number, or the reference's variance times the ratio of the sample counts,
/// whichever is larger: few seeds may all have missed the rare bright samples that carry the variance. The latter is
/// left out where a count is 0, and raised where ours are noisier in many blocks (by the upper quartile of their
/// ratios). Scores are Student's t as normal quantiles, with the degrees of freedom of Welch and Satterthwaite: seeds -
/// 1 for a variance that only the seeds tell, reference_batches - 1 for one that the reference tells, too.
///
/// Throws Error(ExitCode::image) where sizes or channels do not fit, Error(ExitCode::usage) where the variance of our
/// mean is not known: one seed, and no variance of the reference or no counts.
BlockTest block_z_test(const std::vector<Image> &seeds, const Image &reference, const Image &reference_variance,
                       double seed_spp, double reference_spp, int block, int reference_batches = 64);

} // namespace gradus
