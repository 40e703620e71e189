// Lengths of scenes of any unit, in the one that they are rendered in.
#include "runtime/error.h"
#include "runtime/scene/camera_clips.h"
#include "runtime/scene/instances.h"
#include "runtime/scene/mesh_builder.h"
#include "runtime/scene/own_scale.h"
#include "tests/support/placed_scene.h"
#include "tests/support/small_scenes.h"

#include <gmock/gmock.h>

namespace gradus::testing {
namespace {

SceneMaker room(float size) {
    SceneMaker maker(8, 1);
    maker.look({0, size / 4, size}, {0, 0, 0}, 40);
    maker.floor(-size / 2, size / 2, size / 2, maker.material(diffuse(0.5)));
    maker.sphere({0, size / 8, 0}, size / 8, 0);
    maker.point_light({2, 2, 2}, {0, size / 2, 0});
    return maker;
}

TEST(OwnScale, UsualScenesStayAsTheyAre) {
    for (const float size : {0.01f, 1.0f, 1e5f}) {
        Scene scene = room(size).scene;
        EXPECT_EQ(bring_to_own_scale(scene), 1);
        EXPECT_EQ(scene.spheres[0].radius, size / 8);
    }
}

TEST(OwnScale, OthersBecomeAboutOneLarge) {
    for (const float size : {1e-10f, 3e-6f, 1e10f, 1e20f}) {
        Scene scene = room(size).scene;
        const double factor = bring_to_own_scale(scene);
        EXPECT_EQ(std::exp2(std::round(std::log2(factor))), factor) << "a power of two rounds nothing";
        EXPECT_EQ(scene.spheres[0].radius, float(size / 8 * factor));
        EXPECT_GE(8 * scene.spheres[0].radius, 1);
        EXPECT_LT(8 * scene.spheres[0].radius, 2);
        EXPECT_EQ(scene.camera.to_world.m[11], double(size) * factor);
        // The light that arrives at a place stays: intensity over the square of a length.
        EXPECT_FLOAT_EQ(scene.emitters[0].value.r, float(2 * factor * factor));
        EXPECT_EQ(scene.emitters[0].position.y, float(size / 2 * factor));
    }
}

// Kernels take squares of areas: the fourth power of an edge of 1e-11 is no float.
TEST(OwnScale, SmallTrianglesMakeTheSceneLarger) {
    const auto factor_with = [](float size, float edge) {
        SceneMaker maker = room(size);
        for (const float side : {edge, size}) // the smallest decides, not the last
            maker.parallelogram({0, 0, 0}, {side, 0, 0}, {0, side, 0}, 0);
        Scene scene = maker.scene;
        return bring_to_own_scale(scene);
    };
    EXPECT_EQ(factor_with(1, 1e-8f), 1);
    EXPECT_EQ(factor_with(1e-3f, 1e-9f), 1);
    for (const auto &[size, edge] : {std::pair{1e-2f, 3e-11f}, {1e-3f, 3e-12f}, {1e-5f, 3e-14f}, {1e8f, 0.5f}}) {
        const double factor = factor_with(size, edge);
        EXPECT_EQ(std::exp2(std::round(std::log2(factor))), factor);
        EXPECT_GE(edge * factor, 6e-10) << size;
        EXPECT_LE(edge * factor, 4e-9) << size << ": no larger than it need be";
        EXPECT_LE(size * factor, 1e6) << size;
    }
}

// In the world, where kernels take the areas of what is in groups, too.
TEST(OwnScale, TrianglesOfGroupsAreAsSmallAsTheirInstances) {
    const auto factor_with = [](float edge, const std::vector<double> &scales) {
        SceneMaker maker = room(1e-2f);
        maker.parallelogram({0, 0, 0}, {edge, 0, 0}, {0, edge, 0}, 0);
        maker.scene.groups = scales.empty() ? 0 : 1;
        maker.scene.shapes.back().group = scales.empty() ? no_group : 0;
        for (const double by : scales)
            maker.scene.instances.push_back(make_instance(0, scaling({by, by, by})));
        Scene scene = maker.scene;
        return bring_to_own_scale(scene);
    };
    const double expected = factor_with(3e-11f, {});
    EXPECT_GT(expected, 1);
    EXPECT_EQ(factor_with(3e-4f, {1, 1}), 1);
    EXPECT_EQ(factor_with(3e-4f, {1, 1e-7, 1}), expected);
}

TEST(OwnScale, WhatNoFloatHoldsIsRefusedWithItsName) {
    const auto refusal = [](Scene scene) {
        try {
            bring_to_own_scale(scene);
        } catch (const Error &error) {
            EXPECT_EQ(error.code, ExitCode::scene);
            return std::string(error.what());
        }
        return std::string();
    };
    SceneMaker sky = room(1);
    sky.sphere({0, 0, 0}, 1e20f, 0);
    EXPECT_THAT(refusal(sky.scene), ::testing::HasSubstr("shape 2, 2e+20 large"));
    SceneMaker dust = room(1);
    dust.sphere({0, 0, 0}, 1e-11f, 0);
    EXPECT_THAT(refusal(dust.scene), ::testing::HasSubstr("shape 2 is 2e-11 large"));
    SceneMaker beyond = room(1);
    beyond.sphere({3e38f, 0, 0}, 1, 0);
    EXPECT_THAT(refusal(beyond.scene), ::testing::HasSubstr("more than single precision holds"));
    SceneMaker lost = room(1);
    lost.scene.camera.to_world = look_at({1e20, 0, 0}, {0, 0, 0}, {0, 1, 0});
    EXPECT_THAT(refusal(lost.scene), ::testing::HasSubstr("the camera is at 1e+20, 0, 0"));
    EXPECT_EQ(refusal(room(1).scene), "");
}

// At ten million times a scene's extent its picture was of blocks, or black, without a word.
TEST(OwnScale, CamerasFarAwayAreWarnedOf) {
    const auto warned = [](Scene scene) {
        std::string said;
        bring_to_own_scale(scene, [&](const std::string &warning) { said += warning; });
        return said;
    };
    for (const double away : {10.0, 5e4, 5e5, 1e8}) {
        Scene scene = room(1).scene;
        scene.camera.to_world = look_at({0, 0, away * world_bounds(scene).extent()}, {0, 0, 0}, {0, 1, 0});
        EXPECT_EQ(warned(scene).empty(), away < 1e5) << away;
    }
    EXPECT_EQ(warned(Scene()), "");
}

// A vertex far away that no face uses made a scene of 1e37 once.
TEST(OwnScale, VerticesThatNothingUsesDoNotCount) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1e37f, 0, 0}, {2e37f, 1e30f, 0}};
    mesh.triangles = {{0, 1, 2}};
    const BuiltMesh built = build_mesh(mesh, Matrix4(), {});
    for (const Vector3 &p : built.mesh.positions)
        EXPECT_LE(std::fabs(p.x), 1);
}

TEST(OwnScale, LengthsOfTheCameraGoAlong) {
    Scene scene = room(1e9f).scene;
    Camera &camera = scene.camera;
    camera.near_clip = 1e6;
    camera.far_clip = 3e9;
    camera.aperture_radius = 2e7;
    camera.focus_distance = 1e9;
    Scene parallel = scene;
    parallel.camera.kind = Camera::Kind::orthographic;
    const double factor = bring_to_own_scale(scene);
    EXPECT_LT(factor, 1e-8);
    EXPECT_DOUBLE_EQ(camera.near_clip, 1e6 * factor);
    EXPECT_DOUBLE_EQ(camera.far_clip, 3e9 * factor);
    EXPECT_DOUBLE_EQ(camera.aperture_radius, 2e7 * factor);
    EXPECT_DOUBLE_EQ(camera.focus_distance, 1e9 * factor);
    // Here it is the scale of to_world that makes lengths of what it maps.
    const double near_before = near_plane(parallel.camera), far_before = far_plane(parallel.camera);
    const double m = parallel.camera.to_world.m[5];
    EXPECT_EQ(bring_to_own_scale(parallel), factor);
    EXPECT_DOUBLE_EQ(parallel.camera.to_world.m[5], m * factor);
    EXPECT_DOUBLE_EQ(near_plane(parallel.camera), near_before * factor);
    EXPECT_DOUBLE_EQ(far_plane(parallel.camera), far_before * factor);
}

} // namespace
} // namespace gradus::testing
