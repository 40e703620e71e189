// Pairs of vertices for half-vector copies, drawn at random with their edges, and the copy itself in long double.
#pragma once

#include "tests/kernels/long_direction.h"

#include <algorithm>
#include <optional>
#include <random>

namespace gradus::testing {

/// Refracts wi at the microfacet normal m: Walter et al. 2007, eq. 40, eta = index on wo's side over that on wi's.
inline std::optional<LongVector> refracted(LongVector wi, LongVector m, long double eta) {
    const long double c = dot(wi, m), ratio = 1 / eta, squared = 1 + ratio * ratio * (c * c - 1);
    if (squared <= 0)
        return {};
    return (ratio * c - (c < 0 ? -1 : 1) * std::sqrt(squared)) * m - ratio * wi;
}

inline LongVector reflected(LongVector wi, LongVector m) { return 2 * dot(wi, m) * m - wi; }

/// Index on wo's side over that on wi's, 1 for reflection; ior is inside over outside, the inside below.
inline long double eta_of(LongVector wi, bool is_reflection, long double ior) {
    return is_reflection ? 1 : wi.z > 0 ? ior : 1 / ior;
}

/// The microfacet normal that turns wi into wo, on wi's side.
inline LongVector half_vector_of(LongVector wi, LongVector wo, long double eta) {
    const LongVector h = normalized(wi + eta * wo);
    return h.z * wi.z < 0 ? -1.0L * h : h;
}

struct ShiftCase {
    bool is_reflection;
    LongVector wi_base, wo_base, wi_offset;
    double ior_base, ior_offset;

    long double base_eta() const { return eta_of(wi_base, is_reflection, ior_base); }
    long double offset_eta() const { return eta_of(wi_offset, is_reflection, ior_offset); }
    LongVector normal() const { return half_vector_of(wi_base, wo_base, base_eta()); }
    /// The copy, for this base or another wo of the base; NaN where it fails.
    LongVector copy(LongVector wo) const {
        const LongVector m = half_vector_of(wi_base, wo, base_eta());
        if (is_reflection)
            return reflected(wi_offset, m);
        const auto copied = refracted(wi_offset, m, offset_eta());
        return copied ? *copied : LongVector{NAN, NAN, NAN};
    }
    LongVector wo_offset() const { return copy(wo_base); }

    /// Smallest cosine of the four directions against the microfacet's normal.
    double microfacet_cosine() const {
        const LongVector m = normal();
        return double(std::min(std::min(std::fabs(dot(wi_base, m)), std::fabs(dot(wo_base, m))),
                               std::min(std::fabs(dot(wi_offset, m)), std::fabs(dot(wo_offset(), m)))));
    }
    /// Smaller length of the two half vectors before they are normalised.
    double half_vector_length() const {
        return double(std::min(length(wi_base + base_eta() * wo_base), length(wi_offset + offset_eta() * wo_offset())));
    }
};

/// Draws cases where the copy succeeds. A third of the directions is free, a third grazes the microfacet, a third
/// leaves it grazing (near total reflection, where eta < 1); index ratios over [0.4, 2.5], both sides, both events.
class ShiftCases {
  public:
    /// smallest: of the cosines against the microfacet; nearest: of index ratios to 1.
    ShiftCases(unsigned seed, double smallest, double nearest = 0.05)
        : random(seed), smallest(smallest), nearest(nearest) {}

    ShiftCase draw() {
        for (;;) {
            ShiftCase c{};
            c.is_reflection = uniform() < 0.4;
            const long double side = uniform() < 0.5 ? 1 : -1;
            c.ior_base = draw_ior();
            c.ior_offset = uniform() < 0.5 ? c.ior_base : draw_ior();
            const LongVector m = draw_normal(side);
            const auto wi_base = draw_incident(m, eta_of({0, 0, side}, c.is_reflection, c.ior_base));
            const auto wi_offset = draw_incident(m, eta_of({0, 0, side}, c.is_reflection, c.ior_offset));
            if (!wi_base || !wi_offset)
                continue;
            c.wi_base = *wi_base, c.wi_offset = *wi_offset;
            if (complete(c, m, side))
                return c;
        }
    }

    /// One refraction where both materials have that index and no direction grazes the surface; none where the draw
    /// fails.
    std::optional<ShiftCase> draw_refraction_of_index(double ior) {
        ShiftCase c = draw();
        if (c.is_reflection)
            return {};
        const LongVector m = c.normal();
        c.ior_base = c.ior_offset = ior;
        const auto wo = refracted(c.wi_base, m, c.base_eta());
        if (!wo || c.wi_base.z * wo->z > -1e-2L)
            return {};
        c.wo_base = *wo;
        if (!(c.wo_offset().z * c.wi_offset.z < -1e-2L)) // NaN where the copy fails
            return {};
        return c;
    }

    /// One refraction by a microfacet whose normal has that cosine against the surface's; none where the draw fails.
    std::optional<ShiftCase> draw_refraction_at_height(double height) { return draw_at(height, false); }

    /// One reflection or refraction by a microfacet as isotropic GGX of that roughness has them.
    std::optional<ShiftCase> draw_at_roughness(double alpha) {
        const double share = uniform();
        return draw_at(1 / std::hypot(1, alpha * std::sqrt(share / (1 - share))), uniform() < 0.4);
    }

    double uniform() { return std::uniform_real_distribution<double>()(random); }

    LongVector draw_direction() {
        std::normal_distribution<double> normal;
        return normalized({normal(random), normal(random), normal(random)});
    }

  private:
    /// Any directions, and a normal of the given height over the surface.
    std::optional<ShiftCase> draw_at(double height, bool is_reflection) {
        ShiftCase c{};
        c.is_reflection = is_reflection;
        c.ior_base = draw_ior();
        c.ior_offset = uniform() < 0.5 ? c.ior_base : draw_ior();
        c.wi_base = draw_direction(), c.wi_offset = draw_direction();
        const long double side = c.wi_base.z < 0 ? -1 : 1, turn = 2 * M_PI * uniform();
        const long double sine = std::sqrt((1 - (long double)(height)) * (1 + (long double)(height)));
        const LongVector m{sine * std::cos(turn), sine * std::sin(turn), side * height};
        if (dot(m, c.wi_base) > 0 && dot(m, c.wi_offset) > 0 && complete(c, m, side))
            return c;
        return {};
    }
    /// Adds wo_base; false where the base or the copy fails, or comes nearer to a bound than the cases may.
    bool complete(ShiftCase &c, LongVector m, long double side) const {
        if (c.is_reflection)
            c.wo_base = reflected(c.wi_base, m);
        else if (const auto wo = refracted(c.wi_base, m, c.base_eta()))
            c.wo_base = *wo;
        else
            return false;
        const long double expected_side = c.is_reflection ? side : -side;
        const auto is_on = [](LongVector v, long double its_side) { return v.z * its_side > 1e-4L; };
        return is_on(c.wi_base, side) && is_on(c.wi_offset, side) && is_on(c.wo_base, expected_side) &&
               is_on(c.wo_offset(), expected_side) && c.microfacet_cosine() > smallest;
    }
    double draw_ior() {
        for (;;) {
            const double ior = 0.4 * std::pow(2.5 / 0.4, uniform());
            if (std::fabs(ior - 1) > nearest)
                return static_cast<float>(ior);
        }
    }
    /// Half of them near the surface's normal, the others anywhere.
    LongVector draw_normal(long double side) {
        const LongVector any = draw_direction();
        const LongVector m = uniform() < 0.5 ? normalized(LongVector{0, 0, 1} + 0.3L * any) : any;
        return m.z * side < 0 ? -1.0L * m : m;
    }
    std::optional<LongVector> draw_incident(LongVector m, long double eta) {
        const double kind = uniform();
        long double cosine = uniform();
        if (kind > 1 / 3.0)
            cosine = smallest * std::pow(0.3 / smallest, uniform()); // grazing
        if (kind > 2 / 3.0) {                                        // that is the transmitted cosine
            const long double squared = eta * eta * cosine * cosine - (eta - 1) * (eta + 1);
            if (squared <= 0 || squared > 1)
                return {};
            cosine = std::sqrt(squared);
        }
        const LongVector first = perpendicular(m), second = cross(m, first);
        const long double turn = 2 * M_PI * uniform(), sine = std::sqrt(1 - cosine * cosine);
        return cosine * m + (sine * std::cos(turn)) * first + (sine * std::sin(turn)) * second;
    }

    std::mt19937_64 random;
    double smallest, nearest;
};

} // namespace gradus::testing
