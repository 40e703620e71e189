#include "runtime/film/error_calibration.h"

#include <cmath>
#include <cstdlib>
#include <string>

namespace gradus {

std::optional<ErrorCalibration> error_calibration(const Image &image, const Image &reference, const Image &variance) {
    ErrorCalibration calibration;
    std::size_t count = 0;
    for (const char *color : {"R", "G", "B"}) {
        const Channel *values = image.find(color), *errors = image.find(std::string("error.") + color);
        const Channel *right = reference.find(color), *noise = variance.find(color);
        if (!values || !errors || !right)
            return std::nullopt;
        for (std::size_t i = 0; i < values->values.size() && i < right->values.size(); ++i) {
            const double apart = std::fabs(double(values->values[i]) - right->values[i]);
            const double error = std::hypot(errors->values[i], noise ? std::sqrt(noise->values[i]) : 0.0f);
            if (!std::isfinite(apart) || !std::isfinite(error))
                continue;
            calibration.within += apart <= error ? 1 : 0;
            calibration.within_twice += apart <= 2 * error ? 1 : 0;
            ++count;
        }
    }
    if (count == 0)
        return std::nullopt;
    calibration.within /= double(count);
    calibration.within_twice /= double(count);
    if (const auto stated = image.metadata.find("estimated_error"); stated != image.metadata.end())
        calibration.relative_mse = std::strtod(stated->second.c_str(), nullptr);
    return calibration;
}

} // namespace gradus
