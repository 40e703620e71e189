// How right an image is about its own error: its layer `error` against a reference.
#pragma once

#include "runtime/film/image.h"

#include <optional>

namespace gradus {

struct ErrorCalibration {
    /// Shares of the values whose true error is at most once and twice as large as the layer says; of normal errors
    /// 0.683 and 0.954 are.
    double within = 0, within_twice = 0;
    /// The image's metadata `estimated_error`: the relMSE that it takes itself to have.
    std::optional<double> relative_mse;
};

/// Over channels R, G, B; nothing where the image has no such layer or no value is finite. `variance`: of the reference
/// by pixel, in channels of the same names, which counts as error of the difference; an image without channels: none.
std::optional<ErrorCalibration> error_calibration(const Image &image, const Image &reference, const Image &variance);

} // namespace gradus
