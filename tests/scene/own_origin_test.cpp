// Scenes far from the origin, where they are rendered.
#include "runtime/scene/instances.h"
#include "runtime/scene/own_origin.h"
#include "tests/support/placed_scene.h"
#include "tests/support/small_scenes.h"

#include <gtest/gtest.h>

namespace gradus::testing {
namespace {

Scene lit_room() {
    SceneMaker maker(8, 1);
    maker.look({0, 1, 4}, {0, 0, 0}, 40);
    maker.floor(-2, 2, 2, maker.material(diffuse(0.5)));
    maker.sphere({0, 0.5f, 0}, 0.5f, 0);
    return maker.scene;
}

Scene moved(Scene scene, const Double3 &by) {
    place(scene, 1, by);
    return scene;
}

/// Moved by whole numbers, so that nothing is rounded.
TEST(OwnOrigin, WhatIsFarComesNear) {
    const Scene near = lit_room();
    for (const Double3 &by : {Double3{64, 0, 0}, {0, -4096, 0}, {1000, 2000, -3000}}) {
        Scene scene = moved(near, by);
        Emitter light;
        light.kind = Emitter::Kind::point;
        light.value = {2, 2, 2};
        light.position = to_float(add(by, {0, 2, 0}));
        scene.emitters.push_back(light);
        bring_to_own_origin(scene);
        const Bounds bounds = world_bounds(scene);
        for (std::size_t axis = 0; axis < 3; ++axis)
            EXPECT_LE(std::abs(bounds.lower[axis] + bounds.upper[axis]), 0.001);
        // All by the same.
        const Vector3 sphere = scene.spheres[0].center;
        const Double3 off = subtract(to_double(sphere), to_double(near.spheres[0].center));
        for (std::size_t axis = 0; axis < 3; ++axis)
            EXPECT_EQ(scene.camera.to_world.m[4 * axis + 3], near.camera.to_world.m[4 * axis + 3] + off[axis]);
        for (std::size_t i = 0; i < near.meshes[0].positions.size(); ++i)
            EXPECT_EQ(to_double(scene.meshes[0].positions[i]), add(to_double(near.meshes[0].positions[i]), off));
        EXPECT_EQ(to_double(scene.emitters.back().position), add({0, 2, 0}, off));
    }
}

TEST(OwnOrigin, UsualScenesStayAsTheyAre) {
    Scene scene = moved(lit_room(), {10, 20, -15});
    const Scene before = scene;
    bring_to_own_origin(scene);
    EXPECT_EQ(scene.spheres[0].center, before.spheres[0].center);
    EXPECT_EQ(scene.camera.to_world.m, before.camera.to_world.m);
    Scene empty;
    bring_to_own_origin(empty);
}

/// What groups hold stays where it is in them.
TEST(OwnOrigin, InstancesMoveAndGroupsDoNot) {
    Scene scene = lit_room();
    scene.spheres.clear();
    std::erase_if(scene.shapes, [](const Shape &shape) { return shape.kind == Shape::Kind::sphere; });
    scene.shapes[0].group = 0;
    scene.groups = 1;
    Instance instance;
    instance.to_world[3] = 1024;
    scene.instances = {instance};
    instance.to_world[3] = 1032;
    scene.instances.push_back(instance);
    const std::vector<Vector3> before = scene.meshes[0].positions;
    bring_to_own_origin(scene);
    EXPECT_EQ(scene.meshes[0].positions, before);
    EXPECT_EQ(scene.instances[0].to_world[3], -4);
    EXPECT_EQ(scene.instances[1].to_world[3], 4);
}

} // namespace
} // namespace gradus::testing
