// What counts of several turns.
#pragma once

#include <nlohmann/json.hpp>

#include <algorithm>
#include <vector>

namespace gradus::bench {

/// The middle value; the mean of the two middle ones of an even number.
inline double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    return values.size() % 2 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

/// median, least and largest.
inline nlohmann::json spread(const std::vector<double> &values) {
    return {{"median", median(values)},
            {"least", *std::min_element(values.begin(), values.end())},
            {"largest", *std::max_element(values.begin(), values.end())}};
}

} // namespace gradus::bench
