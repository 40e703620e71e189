#include "runtime/film/outliers.h"

#include "runtime/film/metrics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace gradus {

std::vector<double> without_outliers(const std::vector<double> &plane, std::uint32_t width, std::uint32_t height) {
    std::vector<double> result(plane.size()), around;
    for (std::uint32_t y = 0; y < height; ++y) {
        const std::uint32_t rows[] = {y > 0 ? y - 1 : 0, y, std::min(y + 1, height - 1)};
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::uint32_t columns[] = {x > 0 ? x - 1 : 0, x, std::min(x + 1, width - 1)};
            const std::size_t here = std::size_t(y) * width + x;
            around.clear(); // a place beyond an edge is the nearest one within, which may be the pixel itself
            for (const std::uint32_t row : rows)
                for (const std::uint32_t column : columns)
                    if (const std::size_t at = std::size_t(row) * width + column; at != here)
                        around.push_back(plane[at]);
            std::sort(around.begin(), around.end());
            result[here] = around.empty() ? plane[here] : std::clamp(plane[here], around[1], around.end()[-2]);
        }
    }
    return result;
}

std::vector<double> relative_weights(std::vector<double> plane, std::uint32_t width, std::uint32_t height) {
    for (double &value : plane)
        value = std::isfinite(value) ? value : 0;
    std::vector<double> weights = without_outliers(plane, width, height);
    for (double &weight : weights)
        weight = 1 / (weight * weight + relative_mse_epsilon);
    return weights;
}

} // namespace gradus
