// Rays of the camera record against rays computed by hand.
#include "runtime/scene/camera_record.h"

#include "runtime/scene/transform.h"

#include <gtest/gtest.h>

// After GoogleTest, which has template parameters of the names of its macros.
#include "kernels/shared/scene_records.h"

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
    ASSERT_EQ(record.size(), std::size_t(camera_stride));
    EXPECT_EQ(record[camera_filter_radius], 1.75f);
    EXPECT_EQ(record[camera_filter_stddev], 0.4f);
}

} // namespace
} // namespace gradus
