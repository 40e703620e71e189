// Rays of the camera record against rays computed by hand.
#include "runtime/scene/camera_record.h"

#include "runtime/scene/transform.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// After GoogleTest, which has template parameters of the names of its macros.
#define TRAIT_ORTHOGRAPHIC 1
#define TRAIT_THIN_LENS 1
#define TRAIT_NEAR_CLIP 1
#include "kernels/lib/camera_ray.h"

namespace gradus {
namespace {

using namespace lib_float;

/// Unit direction through a place of the film, as the camera stage forms it.
Double3 ray_through(const std::vector<float> &record, double x, double y) {
    Double3 direction;
    for (int axis = 0; axis < 3; ++axis)
        direction[axis] = double(record[camera_corner_x + axis]) + x * record[camera_right_x + axis] +
                          y * record[camera_down_x + axis];
    return normalize(direction);
}

void expect_direction(const Double3 &actual, const Double3 &direction) {
    const Double3 expected = normalize(direction);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(actual[axis], expected[axis], 1e-6) << "axis " << axis;
}

FilmSettings film_of(std::uint32_t width, std::uint32_t height) {
    FilmSettings film;
    film.width = width;
    film.height = height;
    return film;
}

/// Half the width and height of a film of 90 degrees along an axis, at distance 1: tan(45 degrees) is 1.
struct FovCase {
    Camera::FovAxis axis;
    std::uint32_t width, height;
    double half_width, half_height;
};

TEST(CameraRecord, PutsTheFieldOfViewAlongItsAxis) {
    using Axis = Camera::FovAxis;
    const FovCase cases[] = {
        {Axis::x, 400, 200, 1, 0.5},          {Axis::y, 400, 200, 2, 1},        {Axis::smaller, 400, 200, 2, 1},
        {Axis::larger, 400, 200, 1, 0.5},     {Axis::x, 200, 400, 1, 2},        {Axis::y, 200, 400, 0.5, 1},
        {Axis::smaller, 200, 400, 1, 2},      {Axis::larger, 200, 400, 0.5, 1}, {Axis::diagonal, 400, 300, 0.8, 0.6},
        {Axis::diagonal, 300, 400, 0.6, 0.8}, {Axis::smaller, 300, 300, 1, 1},  {Axis::larger, 300, 300, 1, 1}};
    for (const FovCase &c : cases) {
        SCOPED_TRACE(::testing::Message() << "axis " << int(c.axis) << ", " << c.width << " x " << c.height);
        Camera camera; // looks along +z, +y up, +x to the left
        camera.fov = 90;
        camera.fov_axis = c.axis;
        const std::vector<float> record = make_camera_record(camera, film_of(c.width, c.height));
        expect_direction(ray_through(record, 0, 0), {c.half_width, c.half_height, 1});
        expect_direction(ray_through(record, c.width, c.height), {-c.half_width, -c.half_height, 1});
        expect_direction(ray_through(record, c.width, 0), {-c.half_width, c.half_height, 1});
        expect_direction(ray_through(record, 0.5 * c.width, 0.5 * c.height), {0, 0, 1});
        expect_direction(ray_through(record, 0.75 * c.width, 0.5 * c.height), {-0.5 * c.half_width, 0, 1});
    }
}

TEST(CameraRecord, FollowsTheTransformButNotItsScale) {
    Camera camera;
    camera.fov = 90;
    const Double3 origin{1, 2, 3};
    camera.to_world = multiply(look_at(origin, {6, 2, 3}, {0, 0, 1}), scaling({7, 7, 7})); // looks along +x, +z up
    const std::vector<float> record = make_camera_record(camera, film_of(100, 100));
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_FLOAT_EQ(record[camera_origin_x + axis], float(origin[axis]));
    // Left of one who looks along +x with +z up is +y.
    expect_direction(ray_through(record, 0, 0), {1, 1, 1});
    expect_direction(ray_through(record, 100, 0), {1, -1, 1});
    expect_direction(ray_through(record, 0, 100), {1, 1, -1});
    expect_direction(ray_through(record, 50, 50), {1, 0, 0});
}

TEST(CameraRecord, HoldsTheFilter) {
    FilmSettings film = film_of(10, 10);
    film.filter_radius = 1.75f;
    film.filter_stddev = 0.4f;
    const std::vector<float> record = make_camera_record(Camera{}, film);
    ASSERT_EQ(record.size(), std::size_t(camera_stride)); // without a table
    EXPECT_EQ(record[camera_filter_radius], 1.75f);
    EXPECT_EQ(record[camera_filter_stddev], 0.4f);
}

/// On a film of 4 x 2 pixels, at (x, y) of it; the middle of the lens is at lens_1 = 0.
camera_sight sight_of(const Camera &camera, double x, double y, double lens_1 = 0, double lens_2 = 0) {
    const std::vector<float> record = make_camera_record(camera, film_of(4, 2), {true, true});
    return camera_sight_through(record.data(), 1, float(x), float(y), float(lens_1), float(lens_2));
}

void expect_sight(const camera_sight &sight, const Double3 &origin, const Double3 &direction) {
    expect_direction({sight.direction.x, sight.direction.y, sight.direction.z}, direction);
    EXPECT_NEAR(sight.origin.x, origin[0], 1e-5);
    EXPECT_NEAR(sight.origin.y, origin[1], 1e-5);
    EXPECT_NEAR(sight.origin.z, origin[2], 1e-5);
}

// What Mitsuba 3.9 says of such rays.

TEST(CameraRecord, PrincipalPointMovesTheImageRightAndDown) {
    Camera camera;
    camera.fov = 90;
    camera.principal_x = 0.1;
    camera.principal_y = 0.2;
    camera.near_clip = 0.01;
    expect_sight(sight_of(camera, 2, 1), {-0.002, -0.002, 0.01}, {-0.19245, -0.19245, 0.96225});
    expect_sight(sight_of(camera, 0, 0), {0.008, 0.003, 0.01}, {0.608229, 0.228086, 0.760286});
    expect_sight(sight_of(camera, 4, 0), {-0.012, 0.003, 0.01}, {-0.754434, 0.188608, 0.628695});
}

TEST(CameraRecord, RaysBeginAtTheNearPlane) {
    Camera camera;
    camera.fov = 90;
    camera.near_clip = 0.5;
    camera.far_clip = 2;
    expect_sight(sight_of(camera, 2, 1), {0, 0, 0.5}, {0, 0, 1});
    expect_sight(sight_of(camera, 0, 0), {0.5, 0.25, 0.5}, {2, 1, 2});
    EXPECT_DOUBLE_EQ(far_plane(camera), 2);
}

TEST(CameraRecord, OrthographicFilmIsScaledAndItsNearPlaneToo) {
    Camera camera;
    camera.kind = Camera::Kind::orthographic;
    camera.to_world = multiply(translation({1, 2, 3}), scaling({2, 3, 5}));
    camera.near_clip = 0.01;
    camera.far_clip = 1e4;
    expect_sight(sight_of(camera, 2, 1), {1, 2, 3.05}, {0, 0, 1});
    expect_sight(sight_of(camera, 0, 0), {3, 3.5, 3.05}, {0, 0, 1});
    expect_sight(sight_of(camera, 4, 0), {-1, 3.5, 3.05}, {0, 0, 1});
    EXPECT_NEAR(far_plane(camera), 0.05 + 9999.99, 1e-9);
}

TEST(CameraRecord, RaysThroughALensMeetInThePlaneOfFocus) {
    Camera camera;
    camera.kind = Camera::Kind::thin_lens;
    camera.fov = 90;
    camera.aperture_radius = 0.3;
    camera.focus_distance = 2;
    const std::vector<double> places = {0, 0.25, 0.5, 0.99};
    double farthest = 0;
    for (const double lens_1 : places)
        for (const double lens_2 : places) {
            const camera_sight sight = sight_of(camera, 0, 0, lens_1, lens_2);
            EXPECT_NEAR(sight.origin.z, 0, 1e-6); // near_clip is 0
            farthest = std::max(farthest, std::hypot(double(sight.origin.x), double(sight.origin.y)));
            const double steps = 2 / double(sight.direction.z);
            EXPECT_NEAR(sight.origin.x + steps * sight.direction.x, 2, 1e-5);
            EXPECT_NEAR(sight.origin.y + steps * sight.direction.y, 1, 1e-5);
        }
    EXPECT_NEAR(farthest, 0.3 * std::sqrt(0.99), 1e-6);
}

} // namespace
} // namespace gradus
