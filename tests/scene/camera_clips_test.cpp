// Which near and far planes matter to a scene, and the table of filters with negative lobes.
#include "runtime/scene/camera_clips.h"
#include "runtime/scene/filter_table.h"
#include "runtime/scene/transform.h"
#include "tests/support/worse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kernels/lib/filter_table.h"

namespace gradus {
namespace {

using testing::worse;

using namespace lib_float;

/// A camera at the origin that looks along +z, 90 degrees wide, and one triangle.
Scene scene_with(const Vector3 &a, const Vector3 &b, const Vector3 &c) {
    Scene scene;
    scene.camera.fov = 90;
    scene.camera.near_clip = 1;
    scene.camera.far_clip = 10;
    scene.film.width = scene.film.height = 100;
    scene.meshes.push_back({{a, b, c}, {}, {}, {{0, 1, 2}}});
    scene.shapes.push_back({});
    return scene;
}

TEST(CameraClips, CountWhereTheImageShowsWhatTheyCut) {
    const auto near_of = [](const Scene &scene) { return camera_clips(scene).near_clip; };
    const auto far_of = [](const Scene &scene) { return camera_clips(scene).far_clip; };
    const Scene between = scene_with({-1, -1, 2}, {1, -1, 3}, {0, 1, 9});
    EXPECT_FALSE(near_of(between));
    EXPECT_FALSE(far_of(between));
    EXPECT_TRUE(near_of(scene_with({-1, -1, 0.5f}, {1, -1, 3}, {0, 1, 9})));
    EXPECT_TRUE(far_of(scene_with({-1, -1, 2}, {1, -1, 3}, {0, 1, 11})));
    // Across the camera's plane, beside what is shown: a wall of a room.
    const Scene wall = scene_with({5, -9, -9}, {5, 9, -9}, {5, 0, 9});
    EXPECT_FALSE(near_of(wall));
    EXPECT_TRUE(near_of(scene_with({0.1f, -9, -9}, {0.1f, 9, -9}, {0.1f, 0, 9})));
    // Behind the camera.
    EXPECT_FALSE(near_of(scene_with({-1, -1, -1}, {1, -1, -1}, {0, 1, -0.1f})));
    // Large, with no corner in the image.
    EXPECT_TRUE(near_of(scene_with({-50, -50, 0.5f}, {50, -50, 0.5f}, {0, 90, 0.5f})));
    // Beyond the far plane, out of the image.
    EXPECT_FALSE(far_of(scene_with({90, 0, 20}, {91, 0, 20}, {90, 1, 20})));
}

TEST(CameraClips, OfSpheresLensesAndParallelRays) {
    Scene scene = scene_with({-1, -1, 2}, {1, -1, 3}, {0, 1, 9});
    scene.spheres.push_back({{0.3f, 0, 0.5f}, 0.1f});
    scene.shapes.emplace_back().kind = Shape::Kind::sphere;
    EXPECT_TRUE(camera_clips(scene).near_clip);
    scene.spheres[0].center = {3, 0, 0.5f};
    EXPECT_FALSE(camera_clips(scene).near_clip);
    scene.camera.kind = Camera::Kind::thin_lens; // whatever its aperture
    EXPECT_TRUE(camera_clips(scene).near_clip);
    scene.camera.kind = Camera::Kind::orthographic;
    EXPECT_FALSE(camera_clips(scene).near_clip);
    scene.camera.to_world = scaling({4, 4, 1});
    EXPECT_TRUE(camera_clips(scene).near_clip);
    scene.camera.to_world = scaling({4, 4, 0.3});
    EXPECT_FALSE(camera_clips(scene).near_clip);
}

FilmSettings film_of(FilmSettings::Filter filter, float radius) {
    FilmSettings film;
    film.filter = filter;
    film.filter_radius = radius;
    return film;
}

TEST(FilterTable, FiltersAreMitsubas) { // mitsuba 3.9.1, ReconstructionFilter.eval
    const auto expect = [](const FilmSettings &film, std::initializer_list<double> values) {
        double x = 0;
        for (const double value : values) {
            EXPECT_NEAR(signed_filter(film, x), value, 1e-6) << x;
            EXPECT_NEAR(signed_filter(film, -x), value, 1e-6) << x;
            x += 0.5;
        }
    };
    FilmSettings mitchell = film_of(FilmSettings::Filter::mitchell, 2);
    expect(mitchell, {0.888888955, 0.534722268, 0.0555556230, -0.0347219668, 0});
    mitchell.mitchell_b = 0.5f;
    mitchell.mitchell_c = 0.25f;
    expect(mitchell, {0.833333373, 0.520833373, 0.0833333358, -0.0208333395, 0});
    expect(film_of(FilmSettings::Filter::catmullrom, 2), {1, 0.5625, 0, -0.0625, 0});
    expect(film_of(FilmSettings::Filter::lanczos, 3), {1, 0.607927084, 0, -0.135094911, 0, 0.0243170746, 0});
    expect(film_of(FilmSettings::Filter::lanczos, 2), {1, 0.573159158, 0, -0.0636843517, 0});
}

/// The whole of what is drawn up to any place: what an edge there shows.
TEST(FilterTable, DrawsItsIntegral) {
    for (const FilmSettings &film :
         {film_of(FilmSettings::Filter::mitchell, 2), film_of(FilmSettings::Filter::lanczos, 3)}) {
        const std::vector<float> table = make_filter_table(film);
        constexpr int steps = 1 << 20;
        double whole = 0, drawn = 0, exact = 0, worst = 0;
        const auto at = [&](int i) { return ((i + 0.5) / steps * 2 - 1) * film.filter_radius; };
        for (int i = 0; i < steps; ++i)
            whole += signed_filter(film, at(i));
        std::size_t cell = 0;
        for (int i = 0; i < steps; ++i) {
            while (cell + 1 < filter_cells && table[cell + 1] < at(i))
                ++cell;
            const double width = table[cell + 1] - table[cell];
            const double share = std::clamp((at(i) - table[cell]) / width, 0.0, 1.0);
            const float *const ends = &table[filter_cells + 1 + 2 * cell];
            drawn += (ends[0] + share * (ends[1] - ends[0])) / filter_cells / width * (2 * film.filter_radius / steps);
            exact += signed_filter(film, at(i)) / whole;
            worst = worse(worst, std::fabs(drawn - exact));
        }
        EXPECT_NEAR(drawn, 1, 1e-5);
        EXPECT_LT(worst, 1e-5) << int(film.filter);
    }
}

/// Moments of what is drawn, with its weights, against the filter's own.
TEST(FilterTable, DrawsTheFilter) {
    for (const FilmSettings &film :
         {film_of(FilmSettings::Filter::mitchell, 2), film_of(FilmSettings::Filter::catmullrom, 2),
          film_of(FilmSettings::Filter::lanczos, 3), film_of(FilmSettings::Filter::lanczos, 1)}) {
        std::vector<float> record(camera_stride);
        const std::vector<float> table = make_filter_table(film);
        ASSERT_EQ(table.size(), std::size_t(filter_table_size));
        record.insert(record.end(), table.begin(), table.end());
        constexpr int draws = 1 << 18, steps = 1 << 18;
        double drawn[5] = {}, exact[5] = {}, whole = 0;
        for (int i = 0; i < draws; ++i) {
            const filter_sample sample = filter_table_sample(record.data(), 1, (float(i) + 0.5f) / draws);
            ASSERT_LE(std::fabs(sample.offset), film.filter_radius);
            for (int power = 0; power < 5; ++power)
                drawn[power] += sample.weight * std::pow(double(sample.offset), power) / draws;
        }
        for (int i = 0; i < steps; ++i) {
            const double x = ((i + 0.5) / steps * 2 - 1) * film.filter_radius, value = signed_filter(film, x);
            whole += value;
            for (int power = 0; power < 5; ++power)
                exact[power] += value * std::pow(x, power);
        }
        for (int power = 0; power < 5; ++power)
            EXPECT_NEAR(drawn[power], exact[power] / whole, 3e-6 * std::pow(film.filter_radius, power)) << power;
    }
}

TEST(FilterTable, OthersHaveNone) {
    EXPECT_TRUE(make_filter_table(film_of(FilmSettings::Filter::gaussian, 2)).empty());
}

} // namespace
} // namespace gradus
