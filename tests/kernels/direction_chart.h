// A map of the sphere of directions to two unit squares, one a hemisphere, that is fine around the lobe of a BSDF.
//
// Each hemisphere goes to the unit disk by Lambert's equal-area projection (d omega = 2 dA), a disk automorphism
// w = (z - c) / (1 - conj(c) z) moves the lobe's centre c to the middle, and the radius is stretched by
// rho = s p / (1 + s - p), p = q (2 - q). No cell is cut by the horizon, where densities jump, and the second map
// makes cells thin there, where the densities of grazing paths turn steep.
#pragma once

#include "tests/kernels/precision.h"

#include <algorithm>
#include <cmath>
#include <complex>

namespace gradus::testing {

class DirectionChart {
  public:
    /// centre: middle of the lobe; width: where half of the radial range is spent; is_upper: which hemisphere.
    DirectionChart(double x, double y, double z, double width, bool is_upper) : width(width), is_upper(is_upper) {
        const double length = std::hypot(x, y);
        const double radius = std::min(std::sqrt(std::max(0.0, 1 - std::fabs(z))), 0.985);
        centre = length > 1e-9 ? std::complex(x, y) * (radius / length) : 0.0;
    }

    struct Point {
        double q, turn; ///< both in [0, 1]
    };

    Point to_square(double x, double y, double z) const {
        // Its radius is sqrt(1 - |z|), without cancellation.
        const std::complex<double> disk = std::complex(x, y) / std::sqrt(1 + std::fabs(z));
        const auto w = quotient(disk - centre, 1.0 - std::conj(centre) * disk);
        const double rho = std::min(std::sqrt(std::norm(w)), 1.0);
        const double turn = std::arg(w) / (2 * M_PI);
        const double one_minus_p = width * (1 - rho) / (width + rho);
        return {1 - std::sqrt(one_minus_p), turn < 0 ? turn + 1 : turn};
    }

    struct Direction {
        double x, y, z, jacobian; ///< solid angle over area of the square
    };

    Direction to_direction(double q, double turn) const {
        const double p = q * (2 - q);
        const double rho = width * p / (1 + width - p);
        const double rho_per_q = width * (1 + width) / ((1 + width - p) * (1 + width - p)) * 2 * (1 - q);
        const auto w = std::polar(rho, 2 * M_PI * turn);
        const auto denominator = 1.0 + std::conj(centre) * w;
        const auto disk = quotient(w + centre, denominator);
        const double stretch = (1 - std::norm(centre)) / std::norm(denominator);
        const double squared = std::min(std::norm(disk), 1.0);
        const double scale = std::sqrt(2 - squared);
        return {disk.real() * scale, disk.imag() * scale, (is_upper ? 1 : -1) * (1 - squared),
                2 * stretch * stretch * 2 * M_PI * rho * rho_per_q};
    }

  private:
    /// Of numbers of ordinary size; the library's division guards against overflow and takes most of a test's time.
    static std::complex<double> quotient(std::complex<double> a, std::complex<double> b) {
        return a * std::conj(b) / std::norm(b);
    }

    double width;
    bool is_upper;
    std::complex<double> centre;
};

/// The charts of the two hemispheres for a path from wi, fine around the mirrored and the refracted direction.
struct LobeCharts {
    DirectionChart upper, lower;
    const DirectionChart &of(bool is_upper) const { return is_upper ? upper : lower; }
};

inline LobeCharts lobe_charts(lib::vec3 wi, double ior, double alpha) {
    if (alpha >= 1) // no lobe to speak of
        return {{0, 0, 1, 1, true}, {0, 0, -1, 1, false}};
    const bool from_above = wi.z >= 0;
    const double eta = from_above ? ior : 1 / ior;
    double x = -wi.x / eta, y = -wi.y / eta;
    const double sine = std::hypot(x, y);
    if (sine > 0.999) // total reflection: what is transmitted leaves near the horizon
        x *= 0.999 / sine, y *= 0.999 / sine;
    const double z = std::sqrt(1 - x * x - y * y);
    const double width = std::min(1.0, 2 * alpha);
    const DirectionChart reflected(-wi.x, -wi.y, wi.z, width, from_above), refracted(x, y, z, width, !from_above);
    return from_above ? LobeCharts{reflected, refracted} : LobeCharts{refracted, reflected};
}

} // namespace gradus::testing
