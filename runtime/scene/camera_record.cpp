#include "runtime/scene/camera_record.h"

#include "kernels/shared/scene_records.h"

#include <array>
#include <cmath>
#include <numbers>

namespace gradus {

namespace {

using Vec = std::array<double, 3>;

Vec column(const Matrix4 &matrix, int c) { return {matrix.m[c], matrix.m[4 + c], matrix.m[8 + c]}; }

Vec normalized(Vec v) {
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return length > 0 ? Vec{v[0] / length, v[1] / length, v[2] / length} : v;
}

} // namespace

double film_tangent(const Camera &camera, double width, double height) {
    const double tangent = std::tan(camera.fov * std::numbers::pi / 360);
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

std::vector<float> make_camera_record(const Camera &camera, const FilmSettings &film, const CameraClips &clips) {
    using namespace lib_float;
    const double width = film.width, height = film.height;
    const bool is_orthographic = camera.kind == Camera::Kind::orthographic;
    const double half_width = is_orthographic ? 1 : film_tangent(camera, width, height);
    const double half_height = half_width * height / width;
    // The camera's +x points to the left of the image and its +y up.
    const Vec along_x = column(camera.to_world, 0), along_y = column(camera.to_world, 1);
    const Vec left = normalized(along_x), up = normalized(along_y);
    const Vec forward = normalized(column(camera.to_world, 2)), origin = column(camera.to_world, 3);
    // As Mitsuba 3.9 has it: the film is moved to the right and down, so what lies ahead appears left and above.
    const double right_by = 2 * half_width * camera.principal_x, down_by = 2 * half_height * camera.principal_y;
    std::vector<float> record(camera_stride);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto put = [&](int field, double value) {
            record[std::size_t(field) + axis] = static_cast<float>(value);
        };
        if (is_orthographic) {
            put(camera_origin_x, origin[axis] + along_x[axis] + half_height * along_y[axis]);
            put(camera_corner_x, forward[axis]);
            put(camera_step_right_x, -2 / width * along_x[axis]);
            put(camera_step_down_x, -2 * half_height / height * along_y[axis]);
        } else {
            put(camera_origin_x, origin[axis]);
            put(camera_corner_x,
                forward[axis] + (half_width - right_by) * left[axis] + (half_height - down_by) * up[axis]);
            put(camera_right_x, -2 * half_width / width * left[axis]);
            put(camera_down_x, -2 * half_height / height * up[axis]);
        }
        put(camera_forward_x, forward[axis]);
        if (camera.kind == Camera::Kind::thin_lens) {
            put(camera_lens_left_x, camera.aperture_radius * left[axis]);
            put(camera_lens_up_x, camera.aperture_radius * up[axis]);
        }
    }
    record[camera_inverse_focus] = static_cast<float>(1 / camera.focus_distance);
    record[camera_near_clip] = clips.near_clip ? static_cast<float>(near_plane(camera)) : 0;
    record[camera_far_clip] = clips.far_clip ? static_cast<float>(far_plane(camera)) : 3e38f;
    return record;
}

} // namespace gradus
