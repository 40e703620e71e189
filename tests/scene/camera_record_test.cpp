// Rays of the camera record against rays computed by hand.
#include "runtime/scene/camera_record.h"

#include "runtime/scene/transform.h"
#include "tests/support/chi_square.h"
#include "tests/support/worse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>

// After GoogleTest, which has template parameters of the names of its macros.
#define TRAIT_ORTHOGRAPHIC 1
#define TRAIT_THIN_LENS 1
#define TRAIT_NEAR_CLIP 1
#include "kernels/lib/camera_ray.h"

namespace gradus {
namespace {

using testing::worse;

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

TEST(CameraRecord, PrincipalPointMovesTheFilmRightAndDown) {
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
            farthest = worse(farthest, std::hypot(double(sight.origin.x), double(sight.origin.y)));
            const double steps = 2 / double(sight.direction.z);
            EXPECT_NEAR(sight.origin.x + steps * sight.direction.x, 2, 1e-5);
            EXPECT_NEAR(sight.origin.y + steps * sight.direction.y, 1, 1e-5);
        }
    EXPECT_NEAR(farthest, 0.3 * std::sqrt(0.99), 1e-6);
}

/// What a camera sees through a place of the film, in double precision: pixels from the top left, the film's width over
/// its height and the camera say all. The lens's middle is meant.
struct ExactSight {
    Double3 origin, direction; ///< at the lens or the plane where x, y and z begin; of unit length
    Double3 at_focus;          ///< where the ray meets the plane of focus
};

ExactSight exact_sight(const Camera &camera, double width, double height, double x, double y) {
    const Double3 origin = transform_point(camera.to_world, {0, 0, 0});
    const bool is_orthographic = camera.kind == Camera::Kind::orthographic;
    const double half_width = is_orthographic ? 1 : std::tan(camera.fov * 3.14159265358979323846 / 360); // along x
    // To the left and up, at distance 1; an orthographic film is that wide itself.
    const double left = half_width * (1 - 2 * (x / width + (is_orthographic ? 0 : camera.principal_x)));
    const double up = half_width * height / width * (1 - 2 * (y / height + (is_orthographic ? 0 : camera.principal_y)));
    ExactSight sight;
    if (is_orthographic) {
        sight.origin = transform_point(camera.to_world, {left, up, camera.near_clip});
        sight.direction = normalize(transform_vector(camera.to_world, {0, 0, 1}));
        return sight;
    }
    // No scale of the transform counts.
    const auto turned = [&](const Double3 &v) {
        return scale(transform_vector(camera.to_world, v), 1 / length(transform_vector(camera.to_world, {0, 0, 1})));
    };
    sight.direction = normalize(turned({left, up, 1}));
    sight.origin = add(origin, turned(scale({left, up, 1}, camera.near_clip)));
    sight.at_focus = add(origin, turned(scale({left, up, 1}, camera.focus_distance)));
    return sight;
}

// Cameras anywhere, that look anywhere, of any angle, film and near plane.
TEST(CameraRecord, RaysAreThoseOfDoublePrecision) {
    std::mt19937_64 bits(1);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(bits);
    };
    constexpr double rounding = 0x1p-24;
    double worst_origin = 0, worst_direction = 0, worst_focus = 0, worst_lens = 0;
    for (int i = 0; i < 20'000; ++i) {
        Camera camera;
        camera.kind = std::array{Camera::Kind::perspective, Camera::Kind::thin_lens, Camera::Kind::orthographic}[i % 3];
        camera.fov_axis = Camera::FovAxis::x;
        camera.fov = i % 2 == 0 ? uniform(1, 170) : std::pow(10, uniform(-2, 2));
        camera.principal_x = i % 4 == 0 ? 0 : uniform(-1, 1);
        camera.principal_y = i % 4 == 0 ? 0 : uniform(-1, 1);
        camera.near_clip = i % 5 == 0 ? 0 : std::pow(10, uniform(-3, 1));
        camera.far_clip = 1e6;
        camera.aperture_radius = std::pow(10, uniform(-3, 0));
        camera.focus_distance = std::pow(10, uniform(-1, 2));
        const double far = std::pow(10, uniform(-1, 4)), size = i % 7 == 0 ? 1 : std::pow(10, uniform(-1, 1));
        const Double3 place{far * uniform(-1, 1), far * uniform(-1, 1), far * uniform(-1, 1)};
        const Double3 towards{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
        camera.to_world = multiply(look_at(place, add(place, towards), {uniform(-1, 1), 2, uniform(-1, 1)}),
                                   scaling({size, size, size}));
        const auto width = std::uint32_t(uniform(1, 4000)), height = std::uint32_t(uniform(1, 4000));
        const std::vector<float> record = make_camera_record(camera, film_of(width, height), {true, true});
        const auto x = float(uniform(-1, width + 1)), y = float(uniform(-1, height + 1)); // filters reach beyond it
        const bool has_lens = camera.kind == Camera::Kind::thin_lens;
        const camera_sight sight = camera_sight_through(record.data(), 1, x, y, has_lens ? float(uniform(0, 0.99)) : 0,
                                                        float(uniform(0, 0.99)));
        const ExactSight exact = exact_sight(camera, width, height, x, y);
        const Double3 origin{sight.origin.x, sight.origin.y, sight.origin.z};
        const Double3 direction{sight.direction.x, sight.direction.y, sight.direction.z};

        // The direction is a sum of three vectors of single precision, over its length; a lens's point comes to it.
        const auto reach = [&](int field) {
            return length({record[std::size_t(field)], record[std::size_t(field) + 1], record[std::size_t(field) + 2]});
        };
        const double terms = reach(camera_corner_x) + std::fabs(x) * reach(camera_right_x) +
                             std::fabs(y) * reach(camera_down_x) +
                             (has_lens ? camera.aperture_radius / camera.focus_distance : 0);
        const double turned = 8 * rounding * terms;          // of a vector no shorter than 1
        const double away = camera.near_clip * terms * size; // at most, to the near plane
        // Its origin too, on the film of an orthographic camera; at the near plane it errs as the direction does there.
        const double film = reach(camera_origin_x) + std::fabs(x) * reach(camera_step_right_x) +
                            std::fabs(y) * reach(camera_step_down_x);
        const double moved = 8 * rounding * (film + camera.aperture_radius + away) + away * turned * terms;
        if (!has_lens) {
            worst_direction = worse(worst_direction, length(subtract(direction, exact.direction)) / turned);
            worst_origin = worse(worst_origin, length(subtract(origin, exact.origin)) / moved);
            continue;
        }
        // From the lens through the same point of the plane of focus, and begun at the near plane.
        const Double3 forward = normalize(transform_vector(camera.to_world, {0, 0, 1}));
        const double ahead = dot(subtract(exact.at_focus, origin), forward) / dot(direction, forward);
        const double size_there = length(subtract(exact.at_focus, place)) + camera.aperture_radius;
        const double allowed = 8 * rounding * length(place) + 4 * turned * size_there * terms + 4 * moved * terms;
        worst_focus =
            std::max(worst_focus, length(subtract(add(origin, scale(direction, ahead)), exact.at_focus)) / allowed);
        const double depth = dot(subtract(origin, place), forward);
        worst_origin = worse(worst_origin, std::fabs(depth - camera.near_clip) /
                                               (8 * rounding * (length(place) + camera.near_clip * terms)));
        const Double3 on_lens = subtract(origin, scale(direction, depth / dot(direction, forward)));
        worst_lens = worse(worst_lens, length(subtract(on_lens, place)) - camera.aperture_radius -
                                           8 * rounding * (length(place) * (1 + terms) + depth * terms * terms));
    }
    std::printf("over what is allowed: %.2f origins, %.2f directions, %.2f at the focus\n", worst_origin,
                worst_direction, worst_focus);
    EXPECT_LE(worst_origin, 1);
    EXPECT_LE(worst_direction, 1);
    EXPECT_LE(worst_focus, 1);
    EXPECT_LE(worst_lens, 0) << "beyond the lens's rim";
}

// Of many rays through one place of the film, each part of the lens has its share.
TEST(CameraRecord, RaysPassAllOfTheLensEvenly) {
    Camera camera;
    camera.kind = Camera::Kind::thin_lens;
    camera.aperture_radius = 0.25;
    camera.focus_distance = 3;
    std::mt19937_64 bits(2);
    std::uniform_real_distribution<float> uniform;
    constexpr int samples = 100'000, side = 12;
    std::vector<double> counts(side * side);
    for (int i = 0; i < samples; ++i) {
        const camera_sight sight = sight_of(camera, 1.5, 0.5, uniform(bits), uniform(bits));
        const double x = sight.origin.x / 0.25, y = sight.origin.y / 0.25, turns = std::atan2(y, x) / 6.28318530718;
        const int ring = std::min(int((x * x + y * y) * side), side - 1);
        counts[std::size_t(ring * side + std::min(int((turns - std::floor(turns)) * side), side - 1))] += 1;
    }
    const std::vector<double> expected(counts.size(), samples / double(counts.size()));
    EXPECT_GT(testing::chi_square(counts, expected).p_value, 1e-6); // false alarms: once in 10^6
}

} // namespace
} // namespace gradus
