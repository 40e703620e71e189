#include "runtime/film/distributions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gradus {
namespace {

constexpr double smallest_tail = 1e-300;

/// Continued fraction of the incomplete beta function (Abramowitz and Stegun 26.5.8) by Lentz's method; converges
/// fast for x < (a + 1) / (a + b + 2).
double beta_fraction(double a, double b, double x) {
    constexpr double tiny = 1e-300;
    constexpr int most_terms = 10000;
    const auto away_from_zero = [](double value) { return std::abs(value) < tiny ? tiny : value; };
    double c = 1, d = 1 / away_from_zero(1 - (a + b) * x / (a + 1)), result = d;
    for (int m = 1; m < most_terms; ++m) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        d = 1 / away_from_zero(1 + even * d);
        c = away_from_zero(1 + even / c);
        result *= d * c;
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        d = 1 / away_from_zero(1 + odd * d);
        c = away_from_zero(1 + odd / c);
        result *= d * c;
        if (std::abs(d * c - 1) < 1e-15)
            break;
    }
    return result;
}

/// Regularised incomplete beta function I_x(a, b); `complement` is 1 - x, given apart to keep its digits.
double incomplete_beta(double a, double b, double x, double complement) {
    if (x <= 0)
        return 0;
    if (complement <= 0)
        return 1;
    const double front =
        std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log(complement));
    if (x < (a + 1) / (a + b + 2))
        return front * beta_fraction(a, b, x) / a;
    return 1 - front * beta_fraction(b, a, complement) / b;
}

} // namespace

double normal_upper_tail(double z) { return 0.5 * std::erfc(z * 0.70710678118654752440); }

double normal_quantile_of_tail(double tail) {
    tail = std::clamp(tail, smallest_tail, 0.5);
    // Newton's method on the logarithm of the tail, which is concave: from a z that is not too small, as Q(z) is at
    // most exp(-z^2 / 2) / 2, each step comes nearer to the quantile and never below it.
    double z = std::sqrt(-2 * std::log(2 * tail));
    for (int i = 0; i < 50; ++i) {
        const double at_z = normal_upper_tail(z),
                     density = std::exp(-0.5 * z * z) * std::numbers::inv_sqrtpi / std::numbers::sqrt2;
        const double nearer = z + std::log(at_z / tail) * at_z / density;
        if (!(nearer < z))
            break;
        z = nearer;
    }
    return std::max(0.0, z);
}

double student_upper_tail(double t, double degrees_of_freedom) {
    // Abramowitz and Stegun 26.7.1: P(|T| > t) = I_x(n / 2, 1 / 2) with x = n / (n + t^2).
    const double n = degrees_of_freedom, square = t * t;
    if (std::isinf(square))
        return 0;
    return 0.5 * incomplete_beta(0.5 * n, 0.5, n / (n + square), square / (n + square));
}

double student_to_normal(double t, double degrees_of_freedom) {
    if (std::isnan(t))
        return t;
    static const double limit = normal_quantile_of_tail(smallest_tail);
    // With so many degrees of freedom the two differ by less than 1e-6 at |t| = 5.
    constexpr double as_good_as_normal = 1e8;
    double z = std::abs(t);
    if (degrees_of_freedom < as_good_as_normal)
        z = normal_quantile_of_tail(student_upper_tail(z, degrees_of_freedom));
    return std::copysign(std::min(z, limit), t);
}

double sidak_limit(std::size_t count, double alpha) {
    if (count == 0)
        return 0;
    // 1 - (1 - alpha)^(1 / count), without cancellation.
    const double single = -std::expm1(std::log1p(-alpha) / double(count));
    return normal_quantile_of_tail(0.5 * single);
}

std::size_t binomial_limit(std::size_t count, double p, double alpha) {
    double probability = std::exp(double(count) * std::log1p(-p)), below = probability;
    std::size_t k = 0;
    // Where the chance of none underflows, the normal approximation is as good as exact.
    if (probability < 1e-280) {
        const double mean = double(count) * p, deviation = std::sqrt(mean * (1 - p));
        return static_cast<std::size_t>(std::ceil(mean + normal_quantile_of_tail(alpha) * deviation));
    }
    while (k < count && 1 - below >= alpha) {
        probability *= double(count - k) / double(k + 1) * p / (1 - p);
        below += probability;
        ++k;
    }
    return k;
}

} // namespace gradus
