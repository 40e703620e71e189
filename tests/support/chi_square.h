// Pearson's chi-square test for samplers: do counted samples follow the expected cell counts?
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace gradus::testing {

struct ChiSquare {
    double statistic = 0;
    int degrees_of_freedom = 0; ///< 0 where pooling left one cell: then the test says nothing and p_value is 1
    double p_value = 1;         ///< chance of a statistic at least this large if the sampler is right
};

/// Q(a, x) = Gamma(a, x) / Gamma(a), the upper regularised incomplete gamma function; a > 0, x >= 0. Series below
/// a + 1, Lentz's continued fraction above (Abramowitz and Stegun, 6.5.29 and 6.5.31).
inline double upper_incomplete_gamma(double a, double x) {
    if (x <= 0)
        return 1;
    const double prefactor = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (int n = 1; n < 10000 && term > sum * 1e-16; ++n) {
            term *= x / (a + n);
            sum += term;
        }
        return 1 - prefactor * sum;
    }
    double b = x + 1 - a, c = 1e300, d = 1 / b, fraction = d;
    for (int n = 1; n < 10000; ++n) {
        const double numerator = -n * (n - a);
        b += 2;
        d = 1 / (numerator * d + b);
        c = b + numerator / c;
        fraction *= c * d;
        if (std::fabs(c * d - 1) < 1e-15)
            break;
    }
    return prefactor * fraction;
}

/// Tests counts against expected counts (same length, same sum up to what is negligible). Cells are pooled from the
/// smallest upwards until each holds at least `minimum` expected samples, as the chi-square limit asks.
inline ChiSquare chi_square(const std::vector<double> &counts, const std::vector<double> &expected,
                            double minimum = 5) {
    std::vector<std::size_t> order(expected.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return expected[a] < expected[b]; });

    std::vector<std::pair<double, double>> cells; // counted, expected
    double pooled_count = 0, pooled_expected = 0;
    for (const std::size_t cell : order) {
        pooled_count += counts[cell];
        pooled_expected += expected[cell];
        if (pooled_expected >= minimum) {
            cells.emplace_back(pooled_count, pooled_expected);
            pooled_count = pooled_expected = 0;
        }
    }
    if (cells.empty())
        cells.emplace_back(0, 0);
    cells.back().first += pooled_count; // at most what stayed below the minimum
    cells.back().second += pooled_expected;

    ChiSquare result;
    for (const auto &[counted, wanted] : cells)
        if (wanted > 0)
            result.statistic += (counted - wanted) * (counted - wanted) / wanted;
        else if (counted > 0)
            result.statistic = INFINITY;
    result.degrees_of_freedom = static_cast<int>(cells.size()) - 1;
    if (result.degrees_of_freedom > 0)
        result.p_value = upper_incomplete_gamma(0.5 * result.degrees_of_freedom, 0.5 * result.statistic);
    else if (std::isinf(result.statistic))
        result.p_value = 0;
    return result;
}

/// The level at which each of `tests` independent tests is held so that all pass together with chance
/// 1 - family_level if everything is right (Sidak 1967).
inline double sidak_level(double family_level, int tests) { return -std::expm1(std::log1p(-family_level) / tests); }

} // namespace gradus::testing
