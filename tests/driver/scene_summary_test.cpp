#include "driver/scene_summary.h"
#include "runtime/scene/texture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gradus {
namespace {

TEST(SceneSummary, CountsWhatTheSceneHolds) {
    Scene scene;
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 5, 0}, {1, 1, -2}};
    mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    mesh.triangles = {{0, 1, 2}, {1, 2, 3}};
    scene.meshes = {mesh};
    scene.spheres = {{{10, 0, 0}, 2, false}};
    scene.shapes = {{Shape::Kind::mesh, 0, 0, -1, "mesh"}, {Shape::Kind::sphere, 0, 1, 0, "ball"}};
    Material plain, both;
    plain.front.kind = BsdfKind::dielectric;
    both.two_sided = true;
    scene.materials = {plain, both, both};
    both.back.kind = BsdfKind::roughconductor_ggx;
    scene.materials.push_back(both);
    scene.emitters.resize(3);
    scene.emitters[1].kind = Emitter::Kind::point;
    scene.film.width = 10;
    scene.film.height = 5;

    const SceneSummary summary = summarize(scene);
    EXPECT_EQ(summary.meshes, 1u);
    EXPECT_EQ(summary.spheres, 1u);
    EXPECT_EQ(summary.triangles, 2u);
    EXPECT_EQ(summary.vertices, 4u);
    EXPECT_EQ(summary.geometry_bytes, 4u * 12 + 4 * 12 + 2 * 12);
    EXPECT_THAT(summary.lower, ::testing::ElementsAre(0, -2, -2));
    EXPECT_THAT(summary.upper, ::testing::ElementsAre(12, 5, 2));
    using ::testing::Pair;
    EXPECT_THAT(summary.materials, ::testing::ElementsAre(Pair("dielectric", 1), Pair("twosided diffuse", 2),
                                                          Pair("twosided diffuse/roughconductor_ggx", 1)));
    EXPECT_THAT(summary.emitters, ::testing::ElementsAre(Pair("area", 2), Pair("point", 1)));
}

TEST(SceneSummary, CountsPicturesOnce) {
    Scene scene;
    const auto picture = std::make_shared<Bitmap>();
    picture->words.resize(100);
    for (int i = 0; i < 2; ++i)
        scene.textures.emplace_back().bitmap = picture;
    scene.textures.emplace_back().kind = Texture::Kind::checkerboard;
    scene.materials.resize(2);
    scene.materials[0].opacity.texture = 0;
    scene.materials[1].front.blend = 0;
    const SceneSummary summary = summarize(scene);
    using ::testing::Pair;
    EXPECT_THAT(summary.textures, ::testing::ElementsAre(Pair("bitmap", 2), Pair("checkerboard", 1)));
    EXPECT_THAT(summary.materials, ::testing::ElementsAre(Pair("blendbsdf", 1), Pair("mask diffuse", 1)));
    EXPECT_EQ(summary.texture_bytes, 400u);
}

TEST(SceneSummary, AnEmptySceneHasNoBounds) { EXPECT_THAT(summarize(Scene()).lower, ::testing::ElementsAre(0, 0, 0)); }

} // namespace
} // namespace gradus
