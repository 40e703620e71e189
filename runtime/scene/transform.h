// Affine maps in double: chains of transforms as scene files write them, applied to points, vectors and normals.
#pragma once

#include "runtime/scene/scene.h"

#include <array>

namespace gradus {

using Double3 = std::array<double, 3>;

inline Double3 add(const Double3 &a, const Double3 &b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Double3 subtract(const Double3 &a, const Double3 &b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Double3 scale(const Double3 &a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
inline double dot(const Double3 &a, const Double3 &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Double3 cross(const Double3 &a, const Double3 &b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// Of any size: no square overflows.
double length(const Double3 &a);
/// a / |a|. The caller sees to it that a is not zero.
Double3 normalize(const Double3 &a);

inline Double3 to_double(const Vector3 &v) { return {v.x, v.y, v.z}; }
inline Vector3 to_float(const Double3 &v) { return {float(v[0]), float(v[1]), float(v[2])}; }

/// a b: applies b first.
Matrix4 multiply(const Matrix4 &a, const Matrix4 &b);
Matrix4 translation(const Double3 &offset);
Matrix4 scaling(const Double3 &factors);
/// Counter-clockwise about the axis as seen from its tip (right-handed), by degrees. The axis needs no unit length
/// but must not be zero.
Matrix4 rotation(const Double3 &axis, double degrees);
/// A frame at origin with +z towards target, +y as near to up as can be and +x = y x z. `up` must not be parallel
/// to the line of sight.
Matrix4 look_at(const Double3 &origin, const Double3 &target, const Double3 &up);

/// Where the map takes the axis of that number; 3: the origin.
inline Double3 column_of(const Matrix4 &matrix, std::size_t number) {
    return {matrix.m[number], matrix.m[4 + number], matrix.m[8 + number]};
}
Double3 transform_point(const Matrix4 &matrix, const Double3 &point);
Double3 transform_vector(const Matrix4 &matrix, const Double3 &vector);
/// Determinant of the upper left 3x3 part; negative where the map mirrors.
double determinant(const Matrix4 &matrix);
/// The factor by which a map stretches all directions alike, or 0 if it does not.
double uniform_scale(const Matrix4 &matrix);

/// Maps normals: proportional to the inverse transpose, and defined for flat maps too (it is the cofactor matrix
/// times the sign of the determinant, which counts as +1 where it is 0). Results are not normalised.
class NormalMap {
  public:
    explicit NormalMap(const Matrix4 &matrix);
    Double3 operator()(const Double3 &normal) const;

  private:
    std::array<double, 9> m_;
};

} // namespace gradus
