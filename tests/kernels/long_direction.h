// Directions in long double and numerical Jacobians between solid angles: the reference that shifts are held against.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace gradus::testing {

struct LongVector {
    long double x, y, z;
};

inline LongVector operator+(LongVector a, LongVector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline LongVector operator-(LongVector a, LongVector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline LongVector operator*(long double s, LongVector v) { return {s * v.x, s * v.y, s * v.z}; }
inline long double dot(LongVector a, LongVector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline LongVector cross(LongVector a, LongVector b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline long double length(LongVector v) { return std::sqrt(dot(v, v)); }
inline LongVector normalized(LongVector v) { return (1 / length(v)) * v; }

/// A unit vector at a right angle to v.
inline LongVector perpendicular(LongVector v) {
    return normalized(std::fabs(v.x) < 0.6L * length(v) ? cross(v, {1, 0, 0}) : cross(v, {0, 1, 0}));
}

struct NumericalJacobian {
    long double value;
    long double relative_error; ///< an estimate: how much the two best extrapolations differ
};

/// Derivative at 0 of a curve of vectors: central differences, the step halved each time, and Richardson extrapolation
/// (Ridders 1982). The entry of the tableau that differs least from its two parents is taken.
template <class Curve>
LongVector derivative(Curve curve, long double step, long double &error) {
    constexpr int levels = 8;
    std::array<std::array<LongVector, levels>, levels> table;
    LongVector best{};
    error = std::numeric_limits<long double>::infinity();
    for (int level = 0; level < levels; ++level, step /= 2) {
        table[level][0] = (1 / (2 * step)) * (curve(step) - curve(-step));
        long double power = 1;
        for (int order = 1; order <= level; ++order) {
            power *= 4;
            const LongVector finer = table[level][order - 1], coarser = table[level - 1][order - 1];
            table[level][order] = finer + (1 / (power - 1)) * (finer - coarser);
            const long double difference =
                std::max(length(table[level][order] - finer), length(table[level][order] - coarser));
            if (difference < error) // false for NaN: outside of the map's domain
                error = difference, best = table[level][order];
        }
    }
    return best;
}

/// |d map / d w| by solid angle. map takes a small move of the unit vector w, at a right angle to w, and gives a unit
/// vector, or how far that has moved; step: the first one, radians.
template <class Map>
NumericalJacobian solid_angle_jacobian(Map map, LongVector w, long double step) {
    const LongVector first = perpendicular(w), second = cross(w, first);
    std::array<LongVector, 2> derivatives;
    std::array<long double, 2> errors;
    for (int axis = 0; axis < 2; ++axis)
        derivatives[axis] =
            derivative([&](long double t) { return map(t * (axis == 0 ? first : second)); }, step, errors[axis]);
    const long double value = length(cross(derivatives[0], derivatives[1]));
    const long double error = errors[0] * length(derivatives[1]) + errors[1] * length(derivatives[0]);
    return {value, error / value};
}

} // namespace gradus::testing
