#include "runtime/scene/camera_clips.h"

#include "runtime/scene/instances.h"
#include "runtime/scene/transform.h"

#include "runtime/scene/camera_record.h"

#include "kernels/shared/scene_records.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace gradus {

using namespace lib_float;

namespace {

/// normal . p >= offset is inside.
struct HalfSpace {
    Double3 normal;
    double offset;
    double depth(const Double3 &p) const { return dot(normal, p) - offset; }
};

/// Whether any of the triangle is inside of all (Sutherland and Hodgman 1974).
bool reaches(const std::array<Double3, 3> &triangle, const std::vector<HalfSpace> &spaces) {
    for (const HalfSpace &space : spaces) // most are outside of one
        if (std::ranges::all_of(triangle, [&](const Double3 &p) { return space.depth(p) < 0; }))
            return false;
    std::vector<Double3> corners(triangle.begin(), triangle.end()), cut;
    for (const HalfSpace &space : spaces) {
        cut.clear();
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Double3 &a = corners[i], &b = corners[(i + 1) % corners.size()];
            const double at_a = space.depth(a), at_b = space.depth(b);
            if (at_a >= 0)
                cut.push_back(a);
            if ((at_a >= 0) != (at_b >= 0))
                cut.push_back(add(a, scale(subtract(b, a), at_a / (at_a - at_b))));
        }
        corners.swap(cut);
        if (corners.empty())
            return false;
    }
    return true;
}

/// What the image shows beyond its plane at the camera, a filter's reach more at either side.
std::vector<HalfSpace> seen(const Camera &camera, const FilmSettings &film) {
    const std::vector<float> record = make_camera_record(camera, film);
    const auto field = [&](int at) {
        const auto i = std::size_t(at);
        return Double3{record[i], record[i + 1], record[i + 2]};
    };
    const Double3 forward = field(camera_forward_x), origin = column_of(camera.to_world, 3);
    std::vector<HalfSpace> spaces = {{forward, dot(forward, origin)}};
    if (camera.kind == Camera::Kind::thin_lens)
        return spaces; // what is near the lens is seen from anywhere
    const double reach = 1 + film.filter_radius;
    const auto place = [&](double x, double y) { // where a ray begins, and its direction
        const auto along = [&](int base, int right, int down) {
            return add(field(base), add(scale(field(right), x), scale(field(down), y)));
        };
        return std::array{along(camera_origin_x, camera_step_right_x, camera_step_down_x),
                          along(camera_corner_x, camera_right_x, camera_down_x)};
    };
    const double right = film.width + reach, bottom = film.height + reach;
    const std::array<std::array<double, 2>, 4> corners = {
        {{-reach, -reach}, {right, -reach}, {right, bottom}, {-reach, bottom}}};
    const auto [middle, ahead] = place(0.5 * film.width, 0.5 * film.height);
    for (std::size_t i = 0; i < 4; ++i) {
        const auto a = place(corners[i][0], corners[i][1]);
        const auto b = place(corners[(i + 1) % 4][0], corners[(i + 1) % 4][1]);
        // The plane of the two rays.
        Double3 normal = cross(a[1], add(subtract(b[0], a[0]), b[1]));
        if (camera.kind == Camera::Kind::orthographic)
            normal = cross(a[1], subtract(b[0], a[0]));
        if (dot(normal, subtract(add(middle, ahead), a[0])) < 0)
            normal = scale(normal, -1);
        spaces.push_back({normal, dot(normal, a[0])});
    }
    return spaces;
}

} // namespace

double near_plane(const Camera &camera) {
    const double scale_of = camera.kind == Camera::Kind::orthographic ? length(column_of(camera.to_world, 2)) : 1;
    return camera.near_clip * scale_of;
}

double far_plane(const Camera &camera) { return near_plane(camera) + (camera.far_clip - camera.near_clip); }

CameraClips camera_clips(const Scene &scene) {
    const std::vector<HalfSpace> shown = seen(scene.camera, scene.film);
    const HalfSpace &ahead = shown.front();
    const double near_at = near_plane(scene.camera), far_at = far_plane(scene.camera);
    CameraClips clips;
    const auto look_at = [&](double low, double high, const auto &reach) {
        const auto is_shown_within = [&](const HalfSpace &limit) {
            std::vector<HalfSpace> spaces = shown;
            spaces.push_back(limit);
            return reach(spaces);
        };
        if (!clips.near_clip && low < near_at && high > 0 && near_at > 0)
            clips.near_clip = is_shown_within({scale(ahead.normal, -1), -ahead.offset - near_at});
        if (!clips.far_clip && high > far_at)
            clips.far_clip = is_shown_within({ahead.normal, ahead.offset + far_at});
    };
    // Of instances their boxes.
    const std::vector<Bounds> of_groups = group_bounds(scene);
    for (const Instance &instance : scene.instances) {
        const Bounds box = placed_bounds(of_groups[instance.group], matrix_of(instance));
        const Double3 center = scale(add(box.lower, box.upper), 0.5), half = scale(subtract(box.upper, box.lower), 0.5);
        const auto reach = [&](const HalfSpace &space) {
            return std::fabs(space.normal[0]) * half[0] + std::fabs(space.normal[1]) * half[1] +
                   std::fabs(space.normal[2]) * half[2];
        };
        const double depth = ahead.depth(center), deep = reach(ahead);
        look_at(depth - deep, depth + deep, [&](const std::vector<HalfSpace> &spaces) {
            return std::ranges::all_of(spaces,
                                       [&](const HalfSpace &space) { return space.depth(center) > -reach(space); });
        });
        if (clips.near_clip && clips.far_clip)
            return clips;
    }
    for (const Shape &shape : scene.shapes) {
        if (shape.group != no_group)
            continue;
        if (shape.kind == Shape::Kind::sphere) {
            const Sphere &sphere = scene.spheres.at(shape.geometry);
            const Double3 center = to_double(sphere.center);
            const double depth = ahead.depth(center);
            look_at(depth - sphere.radius, depth + sphere.radius, [&](const std::vector<HalfSpace> &spaces) {
                return std::ranges::all_of(spaces, [&](const HalfSpace &space) {
                    return space.depth(center) > -sphere.radius * length(space.normal);
                });
            });
            continue;
        }
        const Mesh &mesh = scene.meshes.at(shape.geometry);
        for (const auto &t : mesh.triangles) {
            const std::array<Double3, 3> corners = {to_double(mesh.positions[t[0]]), to_double(mesh.positions[t[1]]),
                                                    to_double(mesh.positions[t[2]])};
            const auto [low, high] =
                std::minmax({ahead.depth(corners[0]), ahead.depth(corners[1]), ahead.depth(corners[2])});
            look_at(low, high, [&](const std::vector<HalfSpace> &spaces) { return reaches(corners, spaces); });
            if (clips.near_clip && clips.far_clip)
                return clips;
        }
    }
    return clips;
}

} // namespace gradus
