#include "runtime/scene/transform.h"

#include <cmath>
#include <numbers>

namespace gradus {

double length(const Double3 &a) { return std::hypot(a[0], a[1], a[2]); }
Double3 normalize(const Double3 &a) { return scale(a, 1 / length(a)); }

Matrix4 multiply(const Matrix4 &a, const Matrix4 &b) {
    Matrix4 product;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) {
            double sum = 0;
            for (int i = 0; i < 4; ++i)
                sum += a.m[row * 4 + i] * b.m[i * 4 + column];
            product.m[row * 4 + column] = sum;
        }
    return product;
}

Matrix4 translation(const Double3 &offset) {
    Matrix4 result;
    for (int i = 0; i < 3; ++i)
        result.m[i * 4 + 3] = offset[i];
    return result;
}

Matrix4 scaling(const Double3 &factors) {
    Matrix4 result;
    for (int i = 0; i < 3; ++i)
        result.m[i * 5] = factors[i];
    return result;
}

// Rodrigues' formula: cos(t) I + (1 - cos(t)) a a^T + sin(t) [a]x for a unit axis a.
Matrix4 rotation(const Double3 &axis, double degrees) {
    const Double3 a = normalize(axis);
    const double radians = degrees * (std::numbers::pi / 180);
    const double c = std::cos(radians), s = std::sin(radians), d = 1 - c;
    Matrix4 result;
    result.m = {c + d * a[0] * a[0],
                d * a[0] * a[1] - s * a[2],
                d * a[0] * a[2] + s * a[1],
                0,
                d * a[1] * a[0] + s * a[2],
                c + d * a[1] * a[1],
                d * a[1] * a[2] - s * a[0],
                0,
                d * a[2] * a[0] - s * a[1],
                d * a[2] * a[1] + s * a[0],
                c + d * a[2] * a[2],
                0,
                0,
                0,
                0,
                1};
    return result;
}

Matrix4 look_at(const Double3 &origin, const Double3 &target, const Double3 &up) {
    const Double3 z = normalize(subtract(target, origin));
    const Double3 x = normalize(cross(up, z));
    const Double3 y = cross(z, x);
    Matrix4 result;
    for (int i = 0; i < 3; ++i) {
        result.m[i * 4] = x[i];
        result.m[i * 4 + 1] = y[i];
        result.m[i * 4 + 2] = z[i];
        result.m[i * 4 + 3] = origin[i];
    }
    return result;
}

Double3 transform_point(const Matrix4 &matrix, const Double3 &point) {
    const auto &m = matrix.m;
    Double3 result;
    for (int i = 0; i < 3; ++i)
        result[i] = m[i * 4] * point[0] + m[i * 4 + 1] * point[1] + m[i * 4 + 2] * point[2] + m[i * 4 + 3];
    return result;
}

Double3 transform_vector(const Matrix4 &matrix, const Double3 &vector) {
    const auto &m = matrix.m;
    Double3 result;
    for (int i = 0; i < 3; ++i)
        result[i] = m[i * 4] * vector[0] + m[i * 4 + 1] * vector[1] + m[i * 4 + 2] * vector[2];
    return result;
}

namespace {
std::array<Double3, 3> columns(const Matrix4 &matrix) {
    std::array<Double3, 3> result;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            result[column][row] = matrix.m[row * 4 + column];
    return result;
}
} // namespace

double determinant(const Matrix4 &matrix) {
    const auto c = columns(matrix);
    return dot(c[0], cross(c[1], c[2]));
}

double uniform_scale(const Matrix4 &matrix) {
    std::array<Double3, 3> columns;
    for (std::size_t i = 0; i < 3; ++i)
        columns[i] = {matrix.m[i], matrix.m[4 + i], matrix.m[8 + i]};
    const double factor = std::cbrt(std::fabs(determinant(matrix)));
    // Files carry five or six digits; anything beyond that is meant.
    const double tolerance = 1e-3 * factor * factor;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j)
            if (!(std::fabs(dot(columns[i], columns[j]) - (i == j ? factor * factor : 0)) <= tolerance))
                return 0;
    return factor;
}

// The columns of the cofactor matrix are the cross products of the columns of the matrix.
NormalMap::NormalMap(const Matrix4 &matrix) {
    const auto c = columns(matrix);
    const double sign = determinant(matrix) < 0 ? -1 : 1;
    for (int column = 0; column < 3; ++column) {
        const Double3 cofactor = cross(c[(column + 1) % 3], c[(column + 2) % 3]);
        for (int row = 0; row < 3; ++row)
            m_[row * 3 + column] = sign * cofactor[row];
    }
}

Double3 NormalMap::operator()(const Double3 &normal) const {
    Double3 result;
    for (int i = 0; i < 3; ++i)
        result[i] = m_[i * 3] * normal[0] + m_[i * 3 + 1] * normal[1] + m_[i * 3 + 2] * normal[2];
    return result;
}

} // namespace gradus
