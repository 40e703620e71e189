#include "runtime/film/block_test.h"

#include "runtime/error.h"
#include "runtime/film/distributions.h"
#include "runtime/film/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gradus {
namespace {

/// Two renderers that agree still differ by the rounding of their sums of floats: this much of the value.
constexpr double rounding_error = 4e-6;
/// The square of a smaller value is no float, so that its variance was stored as 0.
constexpr double smallest_value = 1e-18;
/// Chance to fail an unbiased estimator, for each of the two limits.
constexpr double false_alarm = 0.001;

/// Pixels [x0, x1) x [y0, y1) of an image of that width.
struct Block {
    std::uint32_t x0, x1, y0, y1, width;
    double pixels() const { return double(x1 - x0) * double(y1 - y0); }
    double mean(const Channel &channel) const {
        double sum = 0;
        for (std::uint32_t y = y0; y < y1; ++y)
            for (std::uint32_t x = x0; x < x1; ++x)
                sum += channel.values[std::size_t(y) * width + x];
        return sum / pixels();
    }
};

/// A variance and how well it is known.
struct Variance {
    double value = 0, degrees_of_freedom = std::numeric_limits<double>::infinity();
};

/// Degrees of freedom of a sum of independent variances (Welch and Satterthwaite).
double combined_degrees_of_freedom(const Variance &a, const Variance &b) {
    const double sum = a.value + b.value;
    const double spread = a.value * a.value / a.degrees_of_freedom + b.value * b.value / b.degrees_of_freedom;
    return spread > 0 ? sum * sum / spread : std::numeric_limits<double>::infinity();
}

/// One channel of everything that takes part.
struct Column {
    std::vector<const Channel *> seeds;
    const Channel *reference = nullptr, *variance = nullptr; ///< the latter nullptr where unknown
    double variance_scale = 0; ///< reference's variance times it is the variance of the mean of ours; 0: unknown
    double reference_degrees_of_freedom = 0;
};

/// The means over one block and what is known of their noise.
struct Measured {
    double ours = 0, reference = 0;
    double reference_variance = 0;
    double sample_variance = 0; ///< of the mean of ours, over the seeds; 0 for one seed
    double floor = 0;           ///< the same from the reference's variance; 0 where unknown
    bool finite() const {
        return std::isfinite(ours) && std::isfinite(reference) && std::isfinite(reference_variance) &&
               std::isfinite(sample_variance);
    }
};

Measured measure(const Column &column, const Block &block) {
    const double count = double(column.seeds.size());
    std::vector<double> means;
    for (const Channel *seed : column.seeds)
        means.push_back(block.mean(*seed));
    Measured result;
    for (const double mean : means)
        result.ours += mean / count;
    if (means.size() > 1) {
        double squares = 0;
        for (const double mean : means)
            squares += (mean - result.ours) * (mean - result.ours);
        result.sample_variance = squares / (count - 1) / count;
    }
    result.reference = block.mean(*column.reference);
    if (column.variance) {
        result.reference_variance = block.mean(*column.variance) / block.pixels();
        result.floor = result.reference_variance * column.variance_scale;
    }
    return result;
}

/// A quantile of chi-square over its degrees of freedom, at z standard deviations (Wilson and Hilferty 1931).
double reduced_chi_square(double degrees_of_freedom, double z) {
    const double spread = 2 / (9 * degrees_of_freedom);
    return std::pow(std::max(0.0, 1 - spread + z * std::sqrt(spread)), 3);
}

/// How much noisier we are than the floor says, at least 1: from the upper quartile over the blocks, which a few
/// bright samples do not decide, and which holds where half of the blocks are of another nature. 0 where the blocks
/// are too few to tell.
double pooled_noise_ratio(const std::vector<Measured> &blocks, double degrees_of_freedom) {
    constexpr std::size_t enough_blocks = 8;
    constexpr double normal_upper_quartile = 0.6745;
    std::vector<double> ratios;
    for (const Measured &block : blocks)
        if (block.finite() && block.floor > 0)
            ratios.push_back(block.sample_variance / block.floor);
    if (ratios.size() < enough_blocks)
        return 0;
    const auto quartile = ratios.begin() + std::ptrdiff_t(ratios.size() * 3 / 4);
    std::nth_element(ratios.begin(), quartile, ratios.end());
    return std::max(1.0, *quartile / reduced_chi_square(degrees_of_freedom, normal_upper_quartile));
}

/// The variance of the mean of ours: the larger of both, the floor raised by the pooled ratio. Where the sample
/// variance is larger by no more than chance has it, it errs to the safe side of a variance that is known from all
/// blocks, and the score is as good as normal; else nothing but the seeds tells the variance, and it is Student's.
Variance variance_of_ours(const Measured &block, const Column &column, double ratio) {
    const double seeds_freedom = double(column.seeds.size()) - 1;
    const double floor = block.floor * std::max(1.0, ratio);
    if (seeds_freedom < 1 || floor >= block.sample_variance)
        return {floor, column.reference_degrees_of_freedom};
    const bool as_expected = ratio > 0 && block.sample_variance <= floor * reduced_chi_square(seeds_freedom, 3);
    return {block.sample_variance, as_expected ? column.reference_degrees_of_freedom : seeds_freedom};
}

/// NaN where nothing varies and both are equal up to rounding.
double score(const Measured &block, const Variance &ours, const Variance &theirs, double &standard_error) {
    const double difference = block.ours - block.reference;
    const double rounding = rounding_error * std::max(std::abs(block.ours), std::abs(block.reference)) + smallest_value;
    standard_error = std::sqrt(ours.value + theirs.value + rounding * rounding);
    if (ours.value + theirs.value == 0 && std::abs(difference) <= 3 * rounding)
        return std::numeric_limits<double>::quiet_NaN();
    return student_to_normal(difference / standard_error, combined_degrees_of_freedom(ours, theirs));
}

void score_column(const Column &column, const std::vector<Block> &blocks, BlockTest &test) {
    std::vector<Measured> measured;
    for (const Block &block : blocks)
        measured.push_back(measure(column, block));
    const double ratio = column.seeds.size() > 1 ? pooled_noise_ratio(measured, double(column.seeds.size()) - 1) : 0;
    for (const Measured &block : measured) {
        double z = std::numeric_limits<double>::quiet_NaN(), standard_error = z;
        if (block.finite())
            z = score(block, variance_of_ours(block, column, ratio),
                      {block.reference_variance, column.reference_degrees_of_freedom}, standard_error);
        else
            ++test.non_finite;
        test.z.push_back(z);
        test.difference.push_back(block.ours - block.reference);
        test.standard_error.push_back(standard_error);
    }
}

void judge(BlockTest &test) {
    for (std::size_t i = 0; i < test.z.size(); ++i) {
        if (std::isnan(test.z[i]))
            continue;
        ++test.tested;
        const double size = std::abs(test.z[i]);
        test.over_three += size > 3 ? 1 : 0;
        if (size > test.largest) {
            test.largest = size;
            test.largest_index = i;
        }
    }
    const double chance = 2 * normal_upper_tail(3);
    test.expected_over_three = chance * double(test.tested);
    // The channels of a block share their paths, and one block may count once for each: the trials are the blocks.
    const std::size_t channels = std::max<std::size_t>(1, test.channels.size());
    test.over_three_limit = channels * binomial_limit((test.tested + channels - 1) / channels, chance, false_alarm);
    test.largest_limit = sidak_limit(test.tested, false_alarm);
}

} // namespace

BlockTest block_z_test(const std::vector<Image> &seeds, const Image &reference, const Image &reference_variance,
                       double seed_spp, double reference_spp, int block, int reference_batches) {
    const bool variance_known = !reference_variance.channels.empty();
    const bool scale_known = variance_known && seed_spp > 0 && reference_spp > 0;
    if (seeds.empty() || (seeds.size() == 1 && !scale_known))
        throw Error(ExitCode::usage, "the variance of our images is not known: give images of several seeds, or a "
                                     "variance image of the reference and both sample counts");
    const std::vector<const Channel *> reference_channels = compared_channels(reference, reference);
    std::vector<Column> columns(reference_channels.size());
    const auto variances =
        variance_known ? compared_channels(reference_variance, reference) : std::vector<const Channel *>();
    for (std::size_t c = 0; c < columns.size(); ++c) {
        columns[c].reference = reference_channels[c];
        columns[c].variance = variance_known ? variances[c] : nullptr;
        columns[c].variance_scale = scale_known ? reference_spp / (seed_spp * double(seeds.size())) : 0;
        columns[c].reference_degrees_of_freedom = std::max(1, reference_batches - 1);
    }
    for (const Image &seed : seeds) {
        const auto channels = compared_channels(seed, reference);
        for (std::size_t c = 0; c < columns.size(); ++c)
            columns[c].seeds.push_back(channels[c]);
    }

    BlockTest test;
    const std::uint32_t side =
        block > 0 ? static_cast<std::uint32_t>(block) : std::max(reference.width, reference.height);
    test.blocks_x = (reference.width + side - 1) / side;
    test.blocks_y = (reference.height + side - 1) / side;
    std::vector<Block> blocks;
    for (std::uint32_t y = 0; y < test.blocks_y; ++y)
        for (std::uint32_t x = 0; x < test.blocks_x; ++x)
            blocks.push_back({x * side, std::min((x + 1) * side, reference.width), y * side,
                              std::min((y + 1) * side, reference.height), reference.width});
    for (const Column &column : columns) {
        test.channels.push_back(column.reference->name);
        score_column(column, blocks, test);
    }
    judge(test);
    return test;
}

} // namespace gradus
