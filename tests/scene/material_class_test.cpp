// Materials whose textures are read alike share a class, and a class has all that its materials need.
#include "runtime/scene/material_class.h"

#include "runtime/scene/scene_tables.h"
#include "tests/support/small_scenes.h"
#include "tests/support/textures.h"

#include <gmock/gmock.h>

#include <cstddef>
#include <set>
#include <string>
#include <utility>

// After all others: its short macro names are not for library headers.
#include "kernels/shared/texture.h"

namespace gradus::testing {
namespace {

using ::testing::Contains;
using ::testing::Pair;

constexpr std::size_t many = 100;

/// Textures: 0 and 1 bytes of gray, 2 halves in colour.
SceneMaker maker_with_textures() {
    SceneMaker maker(4, 1);
    for (const bool is_half : {false, false, true})
        maker.scene.textures.push_back(
            random_texture(8, 8, is_half ? Bitmap::Format::half : Bitmap::Format::byte, is_half));
    return maker;
}

Bsdf with_texture(std::int32_t texture) {
    Bsdf bsdf = diffuse(0.5);
    bsdf.reflectance.texture = texture;
    return bsdf;
}

std::size_t wall_of(SceneMaker &maker, const Bsdf &bsdf) {
    const auto material = maker.material(bsdf);
    maker.parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, material);
    return std::size_t(material);
}

TEST(MaterialClasses, AreSharedByMaterialsThatAreReadAlike) {
    SceneMaker maker = maker_with_textures();
    const std::size_t plain = wall_of(maker, diffuse(0.5)), first = wall_of(maker, with_texture(0)),
                      second = wall_of(maker, with_texture(1)), half = wall_of(maker, with_texture(2));
    const std::size_t unused = std::size_t(maker.material(with_texture(2)));
    const auto ball = maker.material(with_texture(0));
    maker.sphere({0, 0, 0}, 1, ball);
    const MaterialClasses found = material_classes(maker.scene, many);
    ASSERT_EQ(found.classes.size(), 4u);
    ASSERT_EQ(found.of_material.size(), unused + 2);
    EXPECT_EQ(found.of_material[first], found.of_material[second]);
    EXPECT_NE(found.of_material[first], found.of_material[half]);
    EXPECT_NE(found.of_material[first], found.of_material[plain]);
    EXPECT_NE(found.of_material[first], found.of_material[std::size_t(ball)]);

    const MaterialClass &constant = found.classes[found.of_material[plain]];
    EXPECT_EQ(constant.textured, 0);
    EXPECT_EQ(constant.lookups, 0);
    const MaterialClass &bytes = found.classes[found.of_material[first]];
    EXPECT_EQ(bytes.textured, 1 << lib_float::parameter_reflectance);
    EXPECT_EQ(bytes.all_textured, bytes.textured);
    EXPECT_EQ(bytes.parameter.features, texture_features(maker.scene.textures[0]));
    EXPECT_EQ(bytes.parameter.first, 0u);
    EXPECT_EQ(bytes.parameter.last, 1u);
    EXPECT_FALSE(bytes.on_spheres);
    EXPECT_TRUE(found.classes[found.of_material[std::size_t(ball)]].on_spheres);
    EXPECT_THAT(definitions_of(bytes), Contains(Pair("TRAIT_SPHERES", "0")));
    EXPECT_THAT(definitions_of(bytes),
                Contains(Pair("TRAIT_TEXTURES",
                              std::to_string(textures_with_count(texture_features(maker.scene.textures[0]), 2)))));
}

TEST(MaterialClasses, OfABlendHaveWhatItsPartsNeed) {
    SceneMaker maker = maker_with_textures();
    maker.scene.blended = {with_texture(1), diffuse(0.5)};
    maker.scene.blended[1].map = {NormalTexture::Kind::normal, 0};
    maker.scene.blends = {{0, 1, 0.5f}};
    maker.scene.blends[0].weight.texture = 2;
    Bsdf blend;
    blend.blend = 0;
    wall_of(maker, blend);
    const MaterialClasses found = material_classes(maker.scene, many);
    ASSERT_EQ(found.classes.size(), 1u);
    const MaterialClass &one = found.classes[0];
    EXPECT_EQ(one.blends, 1);
    EXPECT_EQ(one.blend_levels, 1);
    EXPECT_EQ(one.blend.features, texture_features(maker.scene.textures[2]));
    EXPECT_EQ(one.blend.first, 2u);
    EXPECT_EQ(one.parameter.first, 1u);
    EXPECT_EQ(one.textured, 1 << lib_float::parameter_reflectance);
    EXPECT_EQ(one.all_textured, 0) << "one part has a constant";
    EXPECT_EQ(one.normals, textured_normals_given);
}

TEST(MaterialClasses, KeepKindsApart) {
    SceneMaker maker = maker_with_textures();
    Bsdf metal = with_texture(0);
    metal.kind = BsdfKind::roughconductor_ggx;
    maker.scene.blended = {diffuse(0.5), metal};
    maker.scene.blends = {{0, 1, 0.5f}};
    Bsdf blend;
    blend.blend = 0;
    const std::size_t plain = wall_of(maker, diffuse(0.5)), textured = wall_of(maker, with_texture(0));
    wall_of(maker, metal);
    wall_of(maker, blend);
    const MaterialClasses found = material_classes(maker.scene, many);
    std::set<std::pair<std::string, std::uint32_t>> kinds;
    for (const KindOfClass &one : kinds_by_class(maker.scene, found))
        EXPECT_TRUE(kinds.emplace(one.kind, one.number).second);
    const std::uint32_t of_textured = found.of_material[textured];
    EXPECT_THAT(kinds, ::testing::UnorderedElementsAre(
                           Pair("diffuse", found.of_material[plain]), Pair("diffuse", of_textured),
                           Pair("diffuse", class_of_blends_and_maps), Pair("roughconductor_ggx", ::testing::_),
                           Pair("roughconductor_ggx", class_of_blends_and_maps)));

    const SceneTables tables = make_scene_tables(maker.scene, scene_traits(maker.scene), {}, &found);
    ASSERT_EQ(tables.kinds.size(), 5u);
    // Two triangles a wall, in the order of the walls; blends are behind all kinds.
    const auto bin = [](std::uint32_t place) { return 1 + 2 * place; };
    EXPECT_EQ(tables.primitive_bin[0], bin(tables.place_of_kind("diffuse", found.of_material[plain])));
    EXPECT_EQ(tables.primitive_bin[2], bin(tables.place_of_kind("diffuse", of_textured)));
    EXPECT_EQ(tables.primitive_bin[6], bin(5));
    EXPECT_EQ(tables.record_kind[4], tables.place_of_kind("diffuse", class_of_blends_and_maps));
    EXPECT_EQ(tables.record_kind[5], tables.place_of_kind("roughconductor_ggx", class_of_blends_and_maps));
}

TEST(MaterialClasses, AreMergedWhereThereAreTooMany) {
    SceneMaker maker = maker_with_textures();
    std::vector<std::size_t> walls;
    for (const Bsdf &bsdf : {diffuse(0.5), with_texture(0), with_texture(2)})
        walls.push_back(wall_of(maker, bsdf));
    maker.sphere({0, 0, 0}, 1, std::int32_t(walls[0])); // the constant one is on both
    for (std::size_t most = 1; most <= 4; ++most) {
        const MaterialClasses found = material_classes(maker.scene, most);
        ASSERT_EQ(found.classes.size(), std::min<std::size_t>(most, 3));
        for (std::size_t i = 0; i < walls.size(); ++i) {
            ASSERT_LT(found.of_material[walls[i]], found.classes.size());
            const MaterialClass &one = found.classes[found.of_material[walls[i]]];
            const int texture = i == 0 ? -1 : i == 1 ? 0 : 2;
            EXPECT_TRUE(one.on_triangles);
            EXPECT_TRUE(i > 0 || one.on_spheres);
            if (texture < 0) {
                EXPECT_EQ(one.all_textured, 0);
                continue;
            }
            const int features = texture_features(maker.scene.textures[std::size_t(texture)]);
            EXPECT_EQ(one.parameter.features & features, features);
            EXPECT_LE(one.parameter.first, std::uint32_t(texture));
            EXPECT_GE(one.parameter.last, std::uint32_t(texture));
            EXPECT_EQ(one.textured, 1 << lib_float::parameter_reflectance);
        }
    }
}

} // namespace
} // namespace gradus::testing
