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

struct Score {
    double z = std::numeric_limits<double>::quiet_NaN();
    double difference = 0, standard_error = 0;
    bool finite = true;
};

Score score_block(const Column &column, const Block &block) {
    const double count = double(column.seeds.size());
    std::vector<double> means;
    for (const Channel *seed : column.seeds)
        means.push_back(block.mean(*seed));
    double mean = 0;
    for (const double value : means)
        mean += value / count;
    Variance ours, theirs{0, column.reference_degrees_of_freedom};
    if (means.size() > 1) {
        double squares = 0;
        for (const double value : means)
            squares += (value - mean) * (value - mean);
        ours = {squares / (count - 1) / count, count - 1};
    }
    if (column.variance) {
        theirs.value = block.mean(*column.variance) / block.pixels();
        const double floor = theirs.value * column.variance_scale;
        if (column.variance_scale > 0 && floor >= ours.value)
            ours = {floor, column.reference_degrees_of_freedom};
    }
    const double reference = block.mean(*column.reference);
    Score score;
    score.difference = mean - reference;
    score.finite = std::isfinite(score.difference) && std::isfinite(ours.value) && std::isfinite(theirs.value);
    if (!score.finite)
        return score;
    const double rounding = rounding_error * std::max(std::abs(mean), std::abs(reference));
    score.standard_error = std::sqrt(ours.value + theirs.value + rounding * rounding);
    const bool constant = ours.value + theirs.value == 0;
    if (constant && std::abs(score.difference) <= 3 * rounding)
        return score;
    score.z = student_to_normal(score.difference / score.standard_error, combined_degrees_of_freedom(ours, theirs));
    return score;
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
    test.over_three_limit = binomial_limit(test.tested, chance, false_alarm);
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
    for (const Column &column : columns) {
        test.channels.push_back(column.reference->name);
        for (std::uint32_t y = 0; y < test.blocks_y; ++y)
            for (std::uint32_t x = 0; x < test.blocks_x; ++x) {
                const Block area{x * side, std::min((x + 1) * side, reference.width), y * side,
                                 std::min((y + 1) * side, reference.height), reference.width};
                const Score score = score_block(column, area);
                test.z.push_back(score.z);
                test.difference.push_back(score.difference);
                test.standard_error.push_back(score.standard_error);
                test.non_finite += score.finite ? 0 : 1;
            }
    }
    judge(test);
    return test;
}

} // namespace gradus
