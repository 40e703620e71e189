#include "runtime/film/outliers.h"

#include "runtime/film/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace gradus {

std::vector<double> without_outliers(const std::vector<double> &plane, std::uint32_t width, std::uint32_t height) {
    std::vector<double> result(plane.size());
    for (std::uint32_t y = 0; y < height; ++y) {
        const std::uint32_t rows[] = {y > 0 ? y - 1 : 0, y, std::min(y + 1, height - 1)};
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::uint32_t columns[] = {x > 0 ? x - 1 : 0, x, std::min(x + 1, width - 1)};
            std::array<double, 8> around;
            std::size_t count = 0;
            for (int v = 0; v < 3; ++v)
                for (int u = 0; u < 3; ++u)
                    if (u != 1 || v != 1)
                        around[count++] = plane[std::size_t(rows[v]) * width + columns[u]];
            std::sort(around.begin(), around.end());
            const std::size_t here = std::size_t(y) * width + x;
            result[here] = std::clamp(plane[here], around[1], around[6]);
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
