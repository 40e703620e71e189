// The variance of a mean that several replicates make together: independent of each other, each unbiased, while the
// samples within one need not be independent (Owen 1995: sequences that are scrambled apart).
#pragma once

#include <span>

namespace gradus {

/// So many samples and their sum.
struct Replicate {
    double sum = 0, count = 0;
};

/// The variance of the sum of the sums over the sum of the counts, unbiased for replicates of any variances, wherever
/// each has less than half of the samples. Else, of one or two samples or where most have been left out, that of
/// samples that are independent within replicates. 0 where fewer than two have a sample.
double variance_of_mean(std::span<const Replicate> replicates);

} // namespace gradus
