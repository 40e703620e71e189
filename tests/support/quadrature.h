// Numerical integration for tests.
#pragma once

#include <array>
#include <cmath>

namespace gradus::testing {

/// Nodes and weights of the 4-point Gauss-Legendre rule on [0, 1]: exact for polynomials up to degree 7.
struct CoarseGaussLegendre {
    static constexpr int size = 4;
    static constexpr std::array<double, size> node = {0.06943184420297371, 0.33000947820757187, 0.6699905217924281,
                                                      0.9305681557970262};
    static constexpr std::array<double, size> weight = {0.17392742256872692, 0.32607257743127307, 0.32607257743127307,
                                                        0.17392742256872692};
};

/// Those of the 6-point rule: exact for polynomials up to degree 11.
struct GaussLegendre {
    static constexpr int size = 6;
    static constexpr std::array<double, size> node = {0.033765242898423986, 0.16939530676686774, 0.38069040695840155,
                                                      0.61930959304159845,  0.83060469323313226, 0.96623475710157601};
    static constexpr std::array<double, size> weight = {0.085662246189585172, 0.18038078652406931,
                                                        0.23395696728634552,  0.23395696728634552,
                                                        0.18038078652406931,  0.085662246189585172};
};

/// Integral of f over [a, b] x [c, d] by one rule in each of panels x panels.
template <class Rule = GaussLegendre, class Function>
double integrate(Function f, double a, double b, double c, double d, int panels = 1) {
    double sum = 0;
    const double width = (b - a) / panels, height = (d - c) / panels;
    for (int i = 0; i < panels; ++i)
        for (int j = 0; j < panels; ++j)
            for (int p = 0; p < Rule::size; ++p)
                for (int q = 0; q < Rule::size; ++q)
                    sum += Rule::weight[p] * Rule::weight[q] *
                           f(a + (i + Rule::node[p]) * width, c + (j + Rule::node[q]) * height);
    return sum * width * height;
}

/// As above, but a panel is halved along both axes until the two rules differ by no more than the tolerance, which is
/// about the error of the coarse one; the other's is counted.
template <class Function>
double integrate_adaptively(Function f, double a, double b, double c, double d, double tolerance, int depth = 9) {
    const double fine = integrate(f, a, b, c, d), coarse = integrate<CoarseGaussLegendre>(f, a, b, c, d);
    if (depth == 0 || std::fabs(fine - coarse) <= tolerance)
        return fine;
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
