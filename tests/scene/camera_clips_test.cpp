// Which near and far planes matter to a scene.
#include "runtime/scene/camera_clips.h"
#include "runtime/scene/transform.h"

#include <gtest/gtest.h>

namespace gradus {
namespace {

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

} // namespace
} // namespace gradus
