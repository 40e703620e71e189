// Long thin triangles: which corner they begin at, and where there are many.
#include "runtime/scene/long_triangles.h"
#include "runtime/scene/scene_tables.h"
#include "runtime/scene/traits.h"
#include "tests/support/small_scenes.h"

#include <gtest/gtest.h>

#include <array>

// After GoogleTest, which has template parameters of the names of its macros.
#include "kernels/shared/scene_records.h"

namespace gradus::testing {
namespace {

using namespace lib_float;

using Corners = std::array<std::uint32_t, 3>;

/// One right triangle, so long and 1 wide, its right angle at vertex 0.
Scene right_triangle(float length, const Corners &corners) {
    SceneMaker maker(4, 1);
    Mesh mesh;
    mesh.positions = {{1, 2, 3}, {1 + length, 2, 3}, {1, 2, 4}};
    mesh.triangles = {corners};
    const std::uint32_t material = maker.material(diffuse(0.5));
    maker.scene.meshes.push_back(mesh);
    maker.shape(Shape::Kind::mesh, 0, material, -1);
    return maker.scene;
}

float offset_of(const Scene &scene) { return make_scene_tables(scene, scene_traits(scene)).triangles[triangle_offset]; }

// Rays start as far off a triangle as the tracer errs there: that is not a matter of the order of its corners.
TEST(LongTriangles, BeginAtTheirWidestCorner) {
    for (const Corners &corners : {Corners{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}) {
        Scene scene = right_triangle(1000, corners);
        begin_at_widest_corners(scene);
        const auto &[first, second, third] = scene.meshes[0].triangles[0];
        EXPECT_NE(first, 1u) << "the sharp corner";
        EXPECT_TRUE(second == (first + 1) % 3 && third == (first + 2) % 3) << "the same side is in front";
        const float square = offset_of(right_triangle(1000, {0, 1, 2}));
        EXPECT_NEAR(offset_of(scene), square, 1e-5f * square);
    }
    EXPECT_GT(offset_of(right_triangle(1000, {1, 2, 0})), 200 * offset_of(right_triangle(1000, {0, 1, 2})));
}

TEST(LongTriangles, OthersStayAsTheyAre) {
    for (const float length : {0.5f, 1.0f, 3.0f}) {
        Scene scene = right_triangle(length, {1, 2, 0});
        begin_at_widest_corners(scene);
        EXPECT_EQ(scene.meshes[0].triangles[0], (Corners{1, 2, 0}));
    }
}

// A triangle without coordinates is as a whole what a texture is put on, from its first corner on.
TEST(LongTriangles, StayWhereTheirCornersSayWhereATextureLies) {
    Scene scene = right_triangle(1000, {1, 2, 0});
    scene.textures.emplace_back();
    scene.materials[scene.shapes[0].material].front.reflectance.texture = 0;
    Scene with_coordinates = scene;
    with_coordinates.meshes[0].texcoords = {{0, 0}, {1, 0}, {0, 1}};
    begin_at_widest_corners(scene);
    EXPECT_EQ(scene.meshes[0].triangles[0], (Corners{1, 2, 0}));
    begin_at_widest_corners(with_coordinates);
    EXPECT_EQ(with_coordinates.meshes[0].triangles[0], (Corners{0, 1, 2}));
}

TEST(LongTriangles, CountByTheirArea) {
    EXPECT_FALSE(has_long_triangles(right_triangle(200, {0, 1, 2})));
    EXPECT_TRUE(has_long_triangles(right_triangle(400, {0, 1, 2})));
    // A splinter on a large surface.
    Scene scene = right_triangle(400, {0, 1, 2});
    Mesh &mesh = scene.meshes[0];
    mesh.positions.push_back({401, 2, 403});
    mesh.triangles.push_back({1, 3, 2});
    EXPECT_FALSE(has_long_triangles(scene));
}

} // namespace
} // namespace gradus::testing
