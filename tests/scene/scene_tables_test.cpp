// The records of a scene: lights with their powers, and primitives in their order.
#include "runtime/scene/scene_tables.h"

#include "runtime/error.h"
#include "runtime/scene/texture_tables.h"
#include "tests/support/small_scenes.h"
#include "tests/support/textures.h"

#include <gtest/gtest.h>

#include <cmath>

// After GoogleTest, which has template parameters of the names of its macros.
#include "kernels/shared/material.h"
#include "kernels/shared/scene_records.h"
#include "kernels/shared/texture.h"

namespace gradus::testing {
namespace {

using namespace lib_float;

SceneTables tables_of(const Scene &scene) { return make_scene_tables(scene, scene_traits(scene)); }

float light_value(const SceneTables &tables, std::size_t light, int field) {
    return tables.lights.at(light * light_stride + std::size_t(field));
}

TEST(LightPowers, DecideHowOftenALightIsChosen) {
    SceneMaker maker(4, 1);
    const std::uint32_t material = maker.material(diffuse(0.5));
    // Two triangles of area 3, radiance 2, 1, 4.
    maker.parallelogram({0, 0, 0}, {2, 0, 0}, {0, 3, 0}, material, maker.emitter(Emitter::Kind::area, {2, 1, 4}));
    // Bounds: x 0 to 2, y 0 to 3, z 0 to 6: of diagonal 7.
    maker.parallelogram({0, 0, 6}, {2, 0, 0}, {0, 3, 0}, material);
    maker.sphere({1, 1.5f, 3}, 0.5f, material, maker.emitter(Emitter::Kind::area, {3, 3, 3}));
    maker.point_light({1, 2, 3}, {5, 6, 7});
    maker.directional_light({0.5f, 0.25f, 1}, {0, -0.6f, 0.8f});
    maker.environment(0.125);
    maker.emitter(Emitter::Kind::point, {0, 0, 0}); // black: no light
    const SceneTables tables = tables_of(maker.scene);

    // Half the choice by power, half in equal shares, for each of the five emitters. The two at infinity count as the
    // mean of the others.
    const double rectangle = M_PI * 6 * luminance(2, 1, 4), ball = M_PI * 4 * M_PI * 0.25 * 3;
    const double point = 4 * M_PI * luminance(1, 2, 3), mean = (rectangle + ball + point) / 3;
    const auto chosen = [&](double power) { return 0.5 * power / (5 * mean) + 0.5 / 5; };
    const double probability[] = {chosen(rectangle) / 2, chosen(rectangle) / 2, chosen(ball),
                                  chosen(point),         chosen(mean),          chosen(mean)};
    const std::uint32_t kinds[] = {light_kind_triangle, light_kind_triangle,    light_kind_sphere,
                                   light_kind_point,    light_kind_directional, light_kind_constant};
    ASSERT_EQ(tables.light_count, 6u);
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(tables.light_kinds[i], kinds[i]) << "light " << i;
        EXPECT_NEAR(light_value(tables, i, light_probability), probability[i], 1e-6) << "light " << i;
    }
    EXPECT_EQ(tables.environment_light, 5u);
    EXPECT_GT(tables.scene_diameter, 7);
    EXPECT_FLOAT_EQ(light_value(tables, 0, light_inverse_area), float(1 / 3.0));
    EXPECT_FLOAT_EQ(light_value(tables, 2, light_inverse_area), float(1 / M_PI));
    EXPECT_EQ(light_value(tables, 3, light_p_x), 5);
    EXPECT_EQ(light_value(tables, 3, light_p_z), 7);
    // Towards the light.
    EXPECT_FLOAT_EQ(light_value(tables, 4, light_p_y), 0.6f);
    EXPECT_FLOAT_EQ(light_value(tables, 4, light_p_z), -0.8f);
    EXPECT_EQ(light_value(tables, 4, light_value_b), 1);
}

// By what they send through a disk as wide as the scene where there is nothing else to measure them by.
TEST(LightPowers, AtInfinityCountAmongThemselves) {
    SceneMaker maker(4, 1);
    maker.sphere({0, 0, 0}, 1, maker.material(diffuse(0.5)));
    maker.directional_light({3, 3, 3}, {0, 0, 1});
    maker.environment(1);
    const SceneTables tables = tables_of(maker.scene);
    ASSERT_EQ(tables.light_count, 2u);
    EXPECT_NEAR(light_value(tables, 0, light_probability), 0.5 * 3 / (3 + M_PI) + 0.25, 1e-6);
    EXPECT_NEAR(light_value(tables, 1, light_probability), 0.5 * M_PI / (3 + M_PI) + 0.25, 1e-6);
}

TEST(LightPowers, OfTheNarrowestSpotIsAboveZero) {
    for (const float cutoff : {0.2f, 1e-3f, 1e-8f, 1e-15f})
        for (const float beam : {0.0f, 0.5f * cutoff, cutoff}) {
            SceneMaker maker(4, 1);
            maker.sphere({0, 0, 0}, 1, maker.material(diffuse(0.5)));
            maker.point_light({5, 5, 5}, {0, 3, 0});
            maker.spot({1, 1, 1}, {0, 3, 0}, {0, -1, 0}, 1, 1);
            Emitter &spot = maker.scene.emitters.back();
            spot.beam = beam;
            spot.cutoff = cutoff;
            const SceneTables tables = tables_of(maker.scene);
            ASSERT_EQ(tables.light_count, 2u);
            const double sent = cutoff > beam
                                    ? 1 - (std::sin(double(cutoff)) - std::sin(double(beam))) / (double(cutoff) - beam)
                                    : 1 - std::cos(double(cutoff));
            const double share = sent / (2 * 5 + sent);
            EXPECT_NEAR(light_value(tables, 1, light_probability), 0.5 * share + 0.25, 1e-6) << cutoff << ' ' << beam;
            EXPECT_NEAR(light_value(tables, 0, light_probability), 0.75 - 0.5 * share, 1e-6) << cutoff << ' ' << beam;
        }
}

TEST(Lights, AreNoneInADarkScene) {
    SceneMaker maker(4, 1);
    maker.cube(maker.material(diffuse(0.5)), maker.emitter(Emitter::Kind::area, {0, 0, 0}));
    const SceneTables tables = tables_of(maker.scene);
    EXPECT_EQ(tables.light_count, 0u);
    // What escaping paths read: black.
    for (const int field : {light_value_r, light_value_g, light_value_b})
        EXPECT_EQ(light_value(tables, tables.environment_light, field), 0);
    for (const std::uint32_t light : tables.primitive_light)
        EXPECT_EQ(light, no_light);
}

TEST(Primitives, AreTrianglesFirstAndThenSpheres) {
    SceneMaker maker(4, 1);
    const std::uint32_t red = maker.material(diffuse(0.2)), blue = maker.material(diffuse(0.7));
    const std::int32_t lamp = maker.emitter(Emitter::Kind::area, {1, 1, 1});
    maker.sphere({1, 2, 3}, 0.25f, blue);
    maker.cube(red);
    maker.sphere({4, 5, 6}, 0.5f, red, lamp, true);
    maker.parallelogram({0, 0, 9}, {1, 0, 0}, {0, 2, 0}, blue, lamp);
    const SceneTables tables = tables_of(maker.scene);
    ASSERT_EQ(tables.triangle_count, 14u);
    ASSERT_EQ(tables.primitive_material.size(), 16u);
    ASSERT_EQ(tables.primitive_light.size(), 16u);
    const std::uint32_t expected_material[] = {red, blue, blue, red};
    const std::size_t places[] = {0, 12, 14, 15};
    for (int i = 0; i < 4; ++i)
        EXPECT_EQ(material_record(tables.primitive_material[places[i]]), expected_material[i]) << places[i];
    EXPECT_EQ(tables.primitive_light[0], no_light);
    EXPECT_EQ(tables.primitive_light[12], 0u);
    EXPECT_EQ(tables.primitive_light[13], 1u);
    EXPECT_EQ(tables.primitive_light[14], no_light);
    EXPECT_EQ(tables.primitive_light[15], 2u);
    EXPECT_EQ(tables.spheres.at(sphere_center_y), 2);
    EXPECT_EQ(tables.spheres.at(sphere_facing), 1);
    EXPECT_EQ(tables.spheres.at(sphere_stride + sphere_radius), 0.5f);
    EXPECT_EQ(tables.spheres.at(sphere_stride + sphere_facing), -1);
    const float *last = &tables.triangles.at(12 * triangle_stride);
    EXPECT_EQ(last[triangle_p0_z], 9);
    EXPECT_EQ(last[triangle_e1_x], 1);
    EXPECT_EQ(last[triangle_e2_y], 2);
}

TEST(Primitives, BringTheirOptionalRecordsOnlyWhereATraitAsks) {
    SceneMaker maker(4, 1);
    const std::uint32_t material = maker.material(diffuse(0.5));
    maker.cube(material);
    SceneTables plain = tables_of(maker.scene);
    EXPECT_TRUE(plain.triangle_normals.empty());
    EXPECT_TRUE(plain.triangle_tangents.empty());
    EXPECT_EQ(plain.spheres.size(), std::size_t(sphere_stride)) << "one that no primitive is";

    maker.scene.materials[material].front.kind = BsdfKind::roughconductor_beckmann;
    maker.scene.materials[material].front.alpha_v = 0.5f;
    maker.scene.meshes[0].normals.assign(maker.scene.meshes[0].positions.size(), {0, 1, 0});
    const SceneTables full = tables_of(maker.scene);
    EXPECT_EQ(full.triangle_normals.size(), std::size_t(12 * normals_stride));
    EXPECT_EQ(full.triangle_normals.at(normals_n1_y), 1);
    EXPECT_EQ(full.triangle_tangents.size(), std::size_t(12 * triangle_tangent_stride));
    EXPECT_GT(table_bytes(full), table_bytes(plain));
}

TEST(Materials, LieAsTheirListSays) {
    SceneMaker maker(4, 1);
    Bsdf bsdf;
    bsdf.kind = BsdfKind::roughconductor_beckmann;
    float next = 0;
#define GRADUS_SET_COLOR(with, name, value, text) bsdf.name = Color(next + 1, next + 2, next + 3), next += 3;
#define GRADUS_SET_NUMBER(with, name, value, text) bsdf.name = ++next;
    GRADUS_MATERIAL_PARAMETERS(GRADUS_SET_COLOR, GRADUS_SET_NUMBER, )
#undef GRADUS_SET_COLOR
#undef GRADUS_SET_NUMBER
    maker.cube(maker.material(two_sided(diffuse(0.25), bsdf)));
    const SceneTables tables = tables_of(maker.scene);
    ASSERT_EQ(tables.materials.size(), std::size_t(2 * material_stride));
    ASSERT_EQ(next, float(material_bsdf));
    for (int field = 0; field < material_bsdf; ++field)
        EXPECT_EQ(tables.materials[std::size_t(material_stride + field)], float(field + 1)) << field;
    EXPECT_EQ(tables.materials[std::size_t(material_stride + material_bsdf)], float(bsdf_kind_roughconductor_beckmann));
    EXPECT_EQ(tables.materials[material_reflectance_g], 0.25f);
    EXPECT_EQ(tables.material_back, (std::vector<std::uint32_t>{1, 1}));
}

// dp/du of a triangle whose texture coordinates are stretched, turned and mirrored.
TEST(Primitives, HaveTangentsAlongU) {
    SceneMaker maker(4, 1);
    Bsdf brushed;
    brushed.kind = BsdfKind::roughconductor_beckmann;
    brushed.alpha_v = 0.5f;
    maker.parallelogram({0, 0, 0}, {2, 0, 0}, {0, 3, 0}, maker.material(brushed));
    Mesh &mesh = maker.scene.meshes[0];
    const auto along = [&](std::array<float, 2> a, std::array<float, 2> b, std::array<float, 2> c) {
        mesh.texcoords = {a, b, c, {0, 0}}; // the second triangle has others
        const SceneTables tables = tables_of(maker.scene);
        const float *t = tables.triangle_tangents.data();
        return normalize(Double3{t[0], t[1], t[2]});
    };
    // The first triangle: (0, 0), (2, 0), (2, 3). u = x / 2, v = y / 3.
    EXPECT_NEAR(along({0, 0}, {1, 0}, {1, 1})[0], 1, 1e-6);
    EXPECT_NEAR(along({1, 0}, {0, 0}, {0, 1})[0], -1, 1e-6) << "mirrored";
    EXPECT_NEAR(along({0, 0}, {0, 1}, {1, 1})[1], 1, 1e-6) << "u along y";
    // u = x / 2 + y / 3, v = y / 3: u grows at a constant v only along x.
    EXPECT_NEAR(along({0, 0}, {1, 0}, {2, 1})[0], 1, 1e-6) << "sheared";
}

/// A lamp of two triangles, of areas 1 and 3, that bears `attribute`; and a plain one of area 2.
SceneMaker lamps(const MeshAttribute &attribute, float scale) {
    SceneMaker maker(4, 1);
    Texture texture;
    texture.kind = Texture::Kind::mesh_attribute;
    texture.attribute = attribute.name;
    texture.scale = {scale, scale, scale};
    texture.highest = 1e30f;
    maker.scene.textures = {texture};
    const std::int32_t bright = maker.emitter(Emitter::Kind::area, {1, 1, 1});
    maker.scene.emitters.back().texture = 0;
    const std::uint32_t material = maker.material(diffuse(0.5));
    maker.parallelogram({0, 0, 0}, {1, 0, 0}, {0, 2, 0}, material, bright);
    Mesh &mesh = maker.scene.meshes.back();
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {-3, 0, 0}};
    mesh.normals.clear();
    mesh.texcoords.clear();
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.attributes = {attribute};
    maker.parallelogram({9, 0, 0}, {1, 0, 0}, {0, 2, 0}, material, maker.emitter(Emitter::Kind::area, {1, 1, 1}));
    return maker;
}

/// Half of the choice is by emitter: the probabilities of the two emitters of these powers, of which one has two parts.
std::vector<double> chosen_by(double first, double second, double plain) {
    const double bright = first + second, total = bright + plain;
    const double of_bright = 0.5 * bright / total + 0.25, of_plain = 0.5 * plain / total + 0.25;
    return {of_bright * first / bright, of_bright * second / bright, of_plain / 2, of_plain / 2};
}

void expect_chosen(const SceneMaker &maker, const std::vector<double> &expected) {
    const SceneTables tables = tables_of(maker.scene);
    ASSERT_EQ(tables.light_count, expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(tables.lights[i * light_stride + light_probability], expected[i], 1e-6) << i;
}

// Lights are chosen by what they emit: of an attribute its mean over each triangle.
TEST(AttributeLights, AreChosenByTheirTriangles) {
    expect_chosen(lamps({"face_a", 1, {5, 0.5f}}, 2), chosen_by(1 * 10, 3 * 1, 2));
    // At the vertices: means 2 and 3.
    expect_chosen(lamps({"vertex_a", 1, {1, 2, 3, 5}}, 1), chosen_by(1 * 2, 3 * 3, 2));
    // Of colours the luminance; the same everywhere is a plain lamp.
    expect_chosen(lamps({"vertex_a", 3, {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}}, 1), chosen_by(1, 3, 2));
    expect_chosen(lamps({"face_a", 3, {1, 0, 0, 0, 0, 1}}, 1), chosen_by(0.212671, 3 * 0.072169, 2));
    // Negative numbers shine as 0; a triangle that is black all over is no light.
    expect_chosen(lamps({"vertex_a", 1, {-1, 6, 0, -7}}, 1), {0.5 * 0.5 + 0.25, 0.25, 0.25});
}

// Where edges of lights are looked for, the lamp is one: its mean over all of it.
TEST(AttributeLights, AreOneWhereTheirEdgesCount) {
    const SceneTables tables = tables_of(lamps({"face_a", 1, {5, 0.5f}}, 2).scene);
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_NEAR(tables.light_means[i], (1 * 10 + 3 * 1) / 4.0, 1e-6);
}

// Kernels look up a texture for every row, compiled for what those of its use have: another might be read beyond its
// end.
TEST(Textures, WhoHasNoneLooksUpOneOfTheSameUse) {
    SceneMaker maker(4, 1);
    const Bitmap::Format formats[] = {Bitmap::Format::byte, Bitmap::Format::word, Bitmap::Format::half,
                                      Bitmap::Format::real};
    for (const Bitmap::Format format : formats)
        maker.scene.textures.push_back(random_texture(8, 8, format, format != Bitmap::Format::byte));
    Texture attribute;
    attribute.kind = Texture::Kind::mesh_attribute;
    attribute.attribute = "face_a";
    maker.scene.textures.insert(maker.scene.textures.begin(), attribute);
    const std::int32_t of_nobody = 0, of_parameter = 1, of_map = 2, of_blend = 3, of_light = 4;
    const std::int32_t lamp = maker.emitter(Emitter::Kind::area, {1, 1, 1});
    maker.scene.emitters[std::size_t(lamp)].texture = of_light;
    Bsdf plain = diffuse(0.5), textured = plain, mapped = plain, blend = plain;
    textured.reflectance.texture = of_parameter;
    mapped.map.kind = NormalTexture::Kind::normal;
    mapped.map.texture = of_map;
    maker.scene.blends.push_back({0, 1, 0.5f});
    maker.scene.blends.back().weight.texture = of_blend;
    maker.scene.blended = {plain, plain};
    blend.blend = 0;
    for (const Bsdf &bsdf : {plain, textured, mapped, blend})
        maker.parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, maker.material(bsdf), lamp);
    maker.point_light({1, 1, 1}, {});
    const SceneTables tables = tables_of(maker.scene);
    for (const std::uint32_t looked_up : tables.material_lookups)
        EXPECT_TRUE(texture_is_absent(looked_up) || looked_up == std::uint32_t(of_parameter)) << looked_up;
    std::size_t maps = 0, blends = 0, lights = 0;
    for (std::size_t i = normal_map_texture; i < tables.normal_maps.size(); i += normal_map_stride, ++maps)
        EXPECT_TRUE(texture_is_absent(tables.normal_maps[i]) || tables.normal_maps[i] == std::uint32_t(of_map));
    for (std::size_t i = blend_weight_texture; i < tables.blends.size(); i += blend_stride, ++blends)
        EXPECT_TRUE(texture_is_absent(tables.blends[i]) || tables.blends[i] == std::uint32_t(of_blend));
    for (std::size_t i = light_texture_texture; i < tables.light_textures.size(); i += light_texture_stride, ++lights)
        EXPECT_EQ(texture_present(tables.light_textures[i]), std::uint32_t(of_light));
    EXPECT_GE(maps, 4u);
    EXPECT_GE(blends, 4u);
    EXPECT_EQ(lights, 8u + 1 + 1);
    EXPECT_TRUE(texture_is_absent(tables.light_textures[8 * light_texture_stride]));
    EXPECT_FALSE(texture_is_absent(tables.light_textures[0]));
    // Whoever takes it for a picture finds one texel.
    EXPECT_EQ(tables.textures[of_nobody * texture_stride + texture_width], 1u);
    EXPECT_LT(tables.textures[of_nobody * texture_stride + texture_offset] + 2, tables.texels.size());
}

// A tree from so many emitters on, or from so many of their parts; lights at infinity do not count.
TEST(SceneTables, HaveALightTreeWhereLightsAreMany) {
    SceneMaker maker(4, 1);
    const std::uint32_t black = maker.material(diffuse(0));
    maker.environment(1);
    maker.lamp({0, 1, 0}, 1, 1, 1, black); // two triangles
    const auto levels = [&](const LightTreeFrom &from) {
        return make_scene_tables(maker.scene, scene_traits(maker.scene), from).light_tree.levels;
    };
    EXPECT_EQ(levels({}), 0u);
    EXPECT_EQ(levels({.lights = 3}), 0u);
    EXPECT_GT(levels({.lights = 2}), 0u);
    EXPECT_EQ(levels({.emitters = 2}), 0u);
    maker.point_light({1, 1, 1}, {0, 2, 0});
    EXPECT_GT(levels({.emitters = 2}), 0u);
}

/// Kernels count the texels of a picture by 32 bits. Of its words nothing is read before it is refused.
TEST(TextureTables, RefusePicturesWhoseTexelsHaveNoNumber) {
    SceneMaker maker(4, 1);
    maker.sphere({0, 0, 0}, 1, maker.material(diffuse(0.5)));
    const auto refusal = [&](std::uint32_t width, std::uint32_t height) {
        auto bitmap = std::make_shared<Bitmap>();
        bitmap->width = width;
        bitmap->height = height;
        Scene scene = maker.scene;
        scene.textures.emplace_back().bitmap = bitmap;
        SceneTables tables;
        try {
            add_textures(scene, tables);
        } catch (const Error &error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(refusal(1 << 16, 1 << 16), "");
    EXPECT_EQ(refusal(1 << 16, (1 << 16) + 1),
              "a picture of 65536 x 65537 texels has more than 2^32, the most that a texture may have");
}

} // namespace
} // namespace gradus::testing
