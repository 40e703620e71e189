// Arguments for the functions of a BSDF, drawn at random, all of them numbers that float holds exactly.
#pragma once

#include "tests/kernels/function_table.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace gradus::testing {

inline double rounded(double x) { return static_cast<float>(x); }

inline std::array<double, 3> draw_direction(std::mt19937_64 &random) {
    std::normal_distribution<double> normal;
    double v[3] = {normal(random), normal(random), normal(random)};
    const double length = std::hypot(v[0], v[1], v[2]);
    return {rounded(v[0] / length), rounded(v[1] / length), rounded(v[2] / length)};
}

/// Roughness over [smallest, 1], index ratios on both sides of 1, coloured factors, any directions.
inline Arguments draw_arguments(std::mt19937_64 &random, double smallest_alpha) {
    std::uniform_real_distribution<double> uniform;
    Arguments a;
    const auto factor = [&] { return rounded(0.1 + 0.9 * uniform(random)); };
    for (double &field : a.material) // reflectances, and whatever has no range of its own below
        field = &field == &a[Field::coat_records] ? 0 : factor(); // no argument of a BSDF, but a number of records
    for (const Field eta : {Field::eta_r, Field::eta_g, Field::eta_b})
        a[eta] = rounded(0.05 + 2 * uniform(random));
    for (const Field k : {Field::k_r, Field::k_g, Field::k_b})
        a[k] = rounded(0.5 + 4 * uniform(random));
    const double ior = 1.1 + 1.4 * uniform(random);
    a[Field::ior] = rounded(uniform(random) < 0.5 ? ior : 1 / ior);
    // A coat that lets light pass as a smooth one does, and a little else.
    const Field coat[] = {Field::coat_0, Field::coat_1, Field::coat_2, Field::coat_3, Field::coat_4,
                          Field::coat_5, Field::coat_6, Field::coat_7, Field::coat_8, Field::coat_9};
    for (std::size_t i = 0; i < std::size(coat); ++i)
        a[coat[i]] = rounded((i < 3 ? std::array{0.6, 0.45, -0.16}[i] : 0.0) + 0.01 * uniform(random));
    a[Field::exponent] = rounded(1 + 50 * uniform(random));
    a[Field::roughness] = rounded(std::pow(smallest_alpha, 0.5 * uniform(random)));
    a[Field::ward_variant] = std::floor(3 * uniform(random));
    a[Field::alpha_u] = rounded(std::pow(smallest_alpha, uniform(random)));
    a[Field::alpha_v] = rounded(std::pow(smallest_alpha, uniform(random)));
    a.wi = draw_direction(random);
    a.wo = draw_direction(random);
    a.u_lobe = std::ldexp(double(random() >> 40), -24);
    a.u1 = std::ldexp(double(random() >> 40), -24);
    a.u2 = std::ldexp(double(random() >> 40), -24);
    return a;
}

/// Grazing directions or microfacets (cosine below 0.01), short half vectors, and the critical angle, where the
/// slope of Fresnel's curve is infinite; and for values below 1e-6 the error is not relative any more.
inline bool is_edge(const Arguments &a, bool is_dielectric) {
    if (std::min(std::fabs(a.wi[2]), std::fabs(a.wo[2])) < 0.01)
        return true;
    const double below = a.wi[2] > 0 ? a[Field::ior] : 1 / a[Field::ior];
    const double eta = is_dielectric && a.wi[2] * a.wo[2] < 0 ? below : 1;
    std::array<double, 3> h;
    for (int axis = 0; axis < 3; ++axis)
        h[axis] = a.wi[axis] + eta * a.wo[axis];
    const double length = std::hypot(h[0], h[1], h[2]);
    double from = 0, to = 0;
    for (int axis = 0; axis < 3; ++axis) {
        from += a.wi[axis] * h[axis] / length;
        to += a.wo[axis] * h[axis] / length;
    }
    const double critical = from * from + (below - 1) * (below + 1);
    return length < 0.1 || std::min(std::fabs(from), std::fabs(to)) < 0.01 ||
           (is_dielectric && std::fabs(critical) < 1e-3);
}

inline double distance(const std::array<double, 3> &a, const std::array<double, 3> &b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

} // namespace gradus::testing
