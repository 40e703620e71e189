#include "runtime/scene/camera_record.h"

#include "kernels/shared/scene_records.h"

#include <array>
#include <cmath>

namespace gradus {

namespace {

using Vec = std::array<double, 3>;

Vec column(const Matrix4 &matrix, int c) { return {matrix.m[c], matrix.m[4 + c], matrix.m[8 + c]}; }

Vec normalized(Vec v) {
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return length > 0 ? Vec{v[0] / length, v[1] / length, v[2] / length} : v;
}

/// Half the film's width at distance 1.
double tangent_x(const Camera &camera, double width, double height) {
    const double tangent = std::tan(camera.fov * 3.14159265358979323846 / 360);
    const double aspect = width / height;
    switch (camera.fov_axis) {
    case Camera::FovAxis::x:
        return tangent;
    case Camera::FovAxis::y:
        return tangent * aspect;
    case Camera::FovAxis::smaller:
        return width < height ? tangent : tangent * aspect;
    case Camera::FovAxis::larger:
        return width > height ? tangent : tangent * aspect;
    case Camera::FovAxis::diagonal:
        return tangent / std::sqrt(1 + 1 / (aspect * aspect));
    }
    return tangent;
}

} // namespace

std::vector<float> make_camera_record(const Camera &camera, const FilmSettings &film) {
    using namespace lib_float;
    const double width = film.width, height = film.height;
    const double half_width = tangent_x(camera, width, height), half_height = half_width * height / width;
    // The camera's +x points to the left of the image and its +y up.
    const Vec left = normalized(column(camera.to_world, 0)), up = normalized(column(camera.to_world, 1));
    const Vec forward = normalized(column(camera.to_world, 2)), origin = column(camera.to_world, 3);
    std::vector<float> record(camera_stride);
    for (int axis = 0; axis < 3; ++axis) {
        record[camera_origin_x + axis] = static_cast<float>(origin[axis]);
        record[camera_corner_x + axis] =
            static_cast<float>(forward[axis] + half_width * left[axis] + half_height * up[axis]);
        record[camera_right_x + axis] = static_cast<float>(-2 * half_width / width * left[axis]);
        record[camera_down_x + axis] = static_cast<float>(-2 * half_height / height * up[axis]);
    }
    record[camera_filter_radius] = film.filter_radius;
    record[camera_filter_stddev] = film.filter_stddev;
    return record;
}

} // namespace gradus
