// How far an image is from its reference. Pure functions of linear pixel values.
//
// Channels: R, G and B where the reference has all three, else every channel of the reference. Each is looked up by
// name in the image. A pixel of which any such value is NaN or infinite, in the image or in the reference, is left
// out; count_non_finite() tells how many there are. All functions throw Error(ExitCode::image) for images of unequal
// size, of no pixels, or where the image lacks a channel; NaN is returned where no pixel is left.
#pragma once

#include "runtime/film/image.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace gradus {

/// Squared radiance that keeps black pixels from deciding relMSE.
constexpr double relative_mse_epsilon = 0.001;

/// The same channels with the same values bit for bit.
bool equal_bits(const Image &a, const Image &b);

/// Mean over pixels and channels of (I - R)^2 / (R^2 + 0.001) (as Hua et al. 2017 compare gradient-domain
/// methods).
double relative_mse(const Image &image, const Image &reference);

/// The same without the worst pixels: those with the largest mean over their channels, `fraction` of all, rounded
/// down. A figure that fireflies do not decide; it is biased and only stands beside relative_mse().
double trimmed_relative_mse(const Image &image, const Image &reference, double fraction = 0.001);

/// What relative_mse() of the exact image against a reference would be on average, from the variance of that reference
/// by pixel and channel: mean of variance / (R^2 + 0.001). No image of a method can be told to be nearer than this.
double relative_variance(const Image &variance, const Image &reference);

/// 10 log10(peak^2 / MSE) in dB on linear values, the peak being reference_peak(). Infinite for equal images.
double psnr(const Image &image, const Image &reference);

/// The 99.9th percentile of all values of the reference: the smallest value that at least 99.9 % do not exceed.
double reference_peak(const Image &reference);

/// Means over pixels and channels.
struct MeanComparison {
    double image = 0, reference = 0;
    double ratio = 0; ///< image / reference; NaN where both are 0
    double bias = 0;  ///< image - reference
};
MeanComparison compare_means(const Image &image, const Image &reference);

/// (I - R) / sqrt(R^2 + 0.001), the mean of its square being relative_mse(), in channels of the reference's names. NaN
/// stays where a value is NaN.
Image relative_error_image(const Image &image, const Image &reference);

/// A picture of signed errors as channels R, G, B in [0, 1], linear: white where the mean over the channels of `error`
/// is 0, to red towards +1 (too bright), to blue towards -1 (too dark), yellow where it is not finite.
Image error_picture(const Image &error);

/// The mean of images pixel by pixel, summed in double, in channels of the first one's names.
Image mean_image(const std::vector<Image> &images);

/// NaN and infinite values in the channels named at the top of this file.
std::uint64_t count_non_finite(const Image &image);

/// One layer as an image of its own: the channels "LAYER.x" under the names "x". Throws Error(ExitCode::image) with
/// the layers that there are where there is none of that name.
Image select_layer(const Image &image, const std::string &layer);

/// The channels of `image` that comparisons to `reference` are over, checked as the top of this file says.
std::vector<const Channel *> compared_channels(const Image &image, const Image &reference);

} // namespace gradus
