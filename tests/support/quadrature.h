// Numerical integration for tests.
#pragma once

#include <array>
#include <cmath>

namespace gradus::testing {

/// Nodes and weights of the 6-point Gauss-Legendre rule on [0, 1]: exact for polynomials up to degree 11.
struct GaussLegendre {
    static constexpr int size = 6;
    static constexpr std::array<double, size> node = {0.033765242898423986, 0.16939530676686774, 0.38069040695840155,
                                                      0.61930959304159845,  0.83060469323313226, 0.96623475710157601};
    static constexpr std::array<double, size> weight = {0.085662246189585172, 0.18038078652406931,
                                                        0.23395696728634552,  0.23395696728634552,
                                                        0.18038078652406931,  0.085662246189585172};
};

/// Integral of f over [a, b] x [c, d] by one Gauss-Legendre rule in each of panels x panels.
template <class Function>
double integrate(Function f, double a, double b, double c, double d, int panels = 1) {
    double sum = 0;
    const double width = (b - a) / panels, height = (d - c) / panels;
    for (int i = 0; i < panels; ++i)
        for (int j = 0; j < panels; ++j)
            for (int p = 0; p < GaussLegendre::size; ++p)
                for (int q = 0; q < GaussLegendre::size; ++q)
                    sum += GaussLegendre::weight[p] * GaussLegendre::weight[q] *
                           f(a + (i + GaussLegendre::node[p]) * width, c + (j + GaussLegendre::node[q]) * height);
    return sum * width * height;
}

/// As above, but each panel is halved along both axes until halving changes its integral by no more than tolerance.
template <class Function>
double integrate_adaptively(Function f, double a, double b, double c, double d, double tolerance, int depth = 9) {
    const double whole = integrate(f, a, b, c, d), halved = integrate(f, a, b, c, d, 2);
    if (depth == 0 || std::fabs(whole - halved) <= tolerance)
        return halved;
    const double x = 0.5 * (a + b), y = 0.5 * (c + d), share = 0.5 * tolerance;
    return integrate_adaptively(f, a, x, c, y, share, depth - 1) +
           integrate_adaptively(f, x, b, c, y, share, depth - 1) +
           integrate_adaptively(f, a, x, y, d, share, depth - 1) +
           integrate_adaptively(f, x, b, y, d, share, depth - 1);
}

/// Integral of f over [a, b].
template <class Function>
double integrate(Function f, double a, double b, int panels) {
    double sum = 0;
    const double width = (b - a) / panels;
    for (int i = 0; i < panels; ++i)
        for (int p = 0; p < GaussLegendre::size; ++p)
            sum += GaussLegendre::weight[p] * f(a + (i + GaussLegendre::node[p]) * width);
    return sum * width;
}

} // namespace gradus::testing
