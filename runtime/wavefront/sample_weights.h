// What samples of one film weigh together, and what the variance of their mean needs of that.
#pragma once

namespace gradus {

/// Of samples that weigh 1 their number, that too, and one less.
struct SampleWeights {
    double of_mean = 0; ///< what their mean is over
    double squares = 0; ///< the sum of the squares
    /// How many variances of a sample the squared deviations from the mean have (weighted_deviation() of
    /// kernels/lib/filter_weight.h): the squares without the first one's, which has no mean before it to be off.
    double of_deviations = 0;

    /// How many variances of a sample the square of (sum * other.of_mean - other's sum * of_mean) has (Chan et al.
    /// 1983, where weights are 1).
    double apart(const SampleWeights &other) const {
        return squares * other.of_mean * other.of_mean + other.squares * of_mean * of_mean;
    }
    /// Takes in others. The deviations of all are those of both, and where apart() is not 0 that square over it.
    void add(const SampleWeights &other) {
        of_deviations += other.of_deviations + (apart(other) > 0 ? 1 : 0);
        of_mean += other.of_mean;
        squares += other.squares;
    }
};

} // namespace gradus
