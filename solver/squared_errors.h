// What two independent halves of the samples tell of the error of an image that is made of both.
//
// Where the image is U = p A + q B, of halves A and B with the shares p and q of the samples, p q (A - B)^2 has the
// variance of U as its mean: A has the variance V / p, B has V / q, so (A - B)^2 has the mean V / (p q). For that
// nothing may be common to both, so samples of one sequence would not do: their halves differ by more than their mean
// is wrong. Where all pixels of a sample share their place within the pixel (gradient-domain methods, and any with a
// filter of negative lobes) these places are such a sequence, and errors at edges are told too high. Edges then err
// alike all over an image, so that what is told of it is as uncertain as of one edge.
#pragma once

#include <vector>

namespace gradus {

/// By pixel and channel, planes as PoissonImages has them. Right on average, and each value by itself as uncertain as
/// the square of one normal number: means over neighbours are of use (methods/error_layer.h). NaN where nothing is
/// known.
struct SquaredErrors {
    std::vector<float> variance;
    /// Of the square of what the mean is wrong by, of either sign; empty where nothing is measured.
    std::vector<float> bias;
};

/// Those of the mean of two halves, of which the first has `share` of the samples.
inline SquaredErrors errors_of_halves(const std::vector<float> &first, const std::vector<float> &second, double share) {
    SquaredErrors errors;
    errors.variance.resize(first.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
        const double apart = double(first[i]) - second[i];
        errors.variance[i] = float(share * (1 - share) * apart * apart);
    }
    return errors;
}

} // namespace gradus
