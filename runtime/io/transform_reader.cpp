#include "runtime/io/transform_reader.h"

#include "runtime/io/text.h"
#include "runtime/scene/transform.h"

#include <cmath>
#include <optional>

namespace gradus {

namespace {

[[noreturn]] void fail(const Element &step, const std::string &message) {
    throw SceneError(step.location, "<" + step.tag + ">: " + message);
}

double number_attribute(const Element &step, const std::string &name, double otherwise) {
    const std::string *text = step.attribute(name);
    if (!text)
        return otherwise;
    const std::optional<double> number = parse_number(*text);
    if (!number)
        fail(step, name + "=\"" + *text + "\" is not a number");
    return *number;
}

std::vector<double> list_attribute(const Element &step, const std::string &name) {
    const std::string *text = step.attribute(name);
    if (!text)
        fail(step, "needs " + name);
    const std::optional<std::vector<double>> numbers = parse_numbers(*text);
    if (!numbers)
        fail(step, name + "=\"" + *text + "\" is not a list of numbers");
    return *numbers;
}

Double3 triple_attribute(const Element &step, const std::string &name) {
    const std::vector<double> numbers = list_attribute(step, name);
    if (numbers.size() != 3)
        fail(step, name + " needs three numbers, not " + std::to_string(numbers.size()));
    return {numbers[0], numbers[1], numbers[2]};
}

/// x, y, z as attributes, or all three in value, which may be one number for all of them.
Double3 components(const Element &step, double otherwise) {
    if (step.attribute("value")) {
        const std::vector<double> numbers = list_attribute(step, "value");
        if (numbers.size() == 1)
            return {numbers[0], numbers[0], numbers[0]};
        return triple_attribute(step, "value");
    }
    return {number_attribute(step, "x", otherwise), number_attribute(step, "y", otherwise),
            number_attribute(step, "z", otherwise)};
}

/// As it is where a file has columns for rows.
bool has_last_column_of_affine_maps(const std::vector<double> &matrix) {
    return matrix[3] == 0 && matrix[7] == 0 && matrix[11] == 0 && matrix[15] == 1;
}

Matrix4 read_matrix(const Element &step) {
    const std::vector<double> values = list_attribute(step, "value");
    Matrix4 result;
    if (values.size() == 16) {
        for (int i = 0; i < 16; ++i)
            result.m[i] = values[i];
        constexpr double tolerance = 1e-6; // what an inverse in single precision may leave there
        const double most = tolerance * std::fabs(values[15]);
        if (!(most > 0) || std::fabs(values[12]) > most || std::fabs(values[13]) > most || std::fabs(values[14]) > most)
            fail(step, "the last row must be 0 0 0 1; projective maps are not supported" +
                           std::string(has_last_column_of_affine_maps(values)
                                           ? ". The last column is 0 0 0 1: is the matrix transposed?"
                                           : ""));
        for (int i = 0; i < 12; ++i)
            result.m[i] /= values[15];
        for (int i = 12; i < 15; ++i)
            result.m[i] = 0;
        result.m[15] = 1;
    } else if (values.size() == 9) {
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                result.m[row * 4 + column] = values[row * 3 + column];
    } else
        fail(step, "value needs 16 or 9 numbers, not " + std::to_string(values.size()));
    return result;
}

Matrix4 read_rotation(const Element &step) {
    if (!step.attribute("angle"))
        fail(step, "needs angle (in degrees)");
    const Double3 axis = components(step, 0);
    const double angle = number_attribute(step, "angle", 0);
    if (length(axis) == 0 && angle == 0)
        return Matrix4();
    if (length(axis) == 0)
        fail(step, "the axis is zero; give x, y or z");
    return rotation(axis, angle);
}

/// Where a file says none, as its program has it: of 2.0 and later, Duff et al. 2017; of 0.x, Pharr and Humphreys 2004.
Double3 usual_up(const Double3 &view, bool is_legacy) {
    const auto [x, y, z] = view;
    if (is_legacy) {
        const Double3 across = std::fabs(x) > std::fabs(y) ? Double3{z, 0, -x} : Double3{0, z, -y};
        return cross(normalize(across), view);
    }
    const double sign = std::copysign(1.0, z), a = -1 / (sign + z);
    return {1 + sign * x * x * a, sign * x * y * a, -sign * x};
}

Matrix4 read_look_at(const Element &step, Diagnostics &diagnostics) {
    const Double3 origin = triple_attribute(step, "origin"), target = triple_attribute(step, "target");
    const Double3 view = subtract(target, origin);
    if (!(length(view) > 0))
        fail(step, "origin and target are the same point");
    if (!step.attribute("up"))
        return look_at(origin, target, usual_up(normalize(view), step.is_legacy()));
    Double3 up = triple_attribute(step, "up");
    if (!(length(cross(normalize(view), up)) > 1e-9 * length(up))) {
        diagnostics.warn(step.location, "<" + step.tag + ">: up is zero or parallel to the view; another is chosen");
        up = std::fabs(view[1]) < 0.9 * length(view) ? Double3{0, 1, 0} : Double3{1, 0, 0};
    }
    return look_at(origin, target, up);
}

} // namespace

Matrix4 read_transform(const Element &transform, Diagnostics &diagnostics) {
    Matrix4 result;
    for (const Element &step : transform.children) {
        const std::string kind = lower_case(step.tag);
        Matrix4 matrix;
        if (kind == "matrix")
            matrix = read_matrix(step);
        else if (kind == "translate")
            matrix = translation(components(step, 0));
        else if (kind == "scale")
            matrix = scaling(components(step, 1));
        else if (kind == "rotate")
            matrix = read_rotation(step);
        else if (kind == "lookat")
            matrix = read_look_at(step, diagnostics);
        else
            fail(step, "not a step of a transform (known: matrix, lookat, translate, rotate, scale)");
        result = multiply(matrix, result);
    }
    for (double value : result.m)
        if (!std::isfinite(value))
            throw SceneError(transform.location, "<transform>: a number of the resulting matrix is not finite");
    return result;
}

} // namespace gradus
