#include "bench/kernels/solver_traffic.h"

#include "kernels/shared/solver_shared.h"

#include <map>

namespace gradus::bench {

namespace {

// From reading kernels/solver. An item is one pixel, but for the interpolation: 8 pixels of a coarse row. Of a grid's
// tiles a pixel counts.
const std::map<std::string, double> values_of_item = {
    {"residual", 3},                           // u, right side; residual
    {"smooth", 4},                             // u, right side, inverse diagonal; smoothed: a step of Chebyshev's
    {"descend", 3.25},                         // right side, inverse diagonal; smoothed, a quarter of a coarse pixel
    {"ascend", 5},                             // u, right side, inverse diagonal; what it adds to, twice
    {"prolong", 8 / 2 + 16 + 16},              // coarse, each of its rows for two fine ones; u twice
    {"direction", 4.125},                      // z, old direction; direction, image, an eighth of a sum's parts
    {"advance", 6},                            // direction, image, u, residual; u, residual
    {"reduce_products", SOLVER_REDUCTION + 1}, // <r, r>, which is the first that a solve asks for
};

} // namespace

std::optional<double> solver_traffic(const std::string &kernel) {
    const auto found = values_of_item.find(kernel);
    return found == values_of_item.end() ? std::nullopt : std::optional<double>(found->second);
}

} // namespace gradus::bench
