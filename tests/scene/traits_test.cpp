#include "runtime/scene/traits.h"

#include "runtime/scene/roughness.h"
#include "tests/support/small_scenes.h"

#include <gmock/gmock.h>

#include <set>

namespace gradus::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

/// The traits that are on.
std::set<std::string> traits_of(const Scene &scene) {
    std::set<std::string> on;
    for (const auto &[name, value] : scene_traits(scene)) {
        EXPECT_TRUE(value == 0 || value == 1) << name;
        if (value)
            on.insert(name);
    }
    return on;
}

SceneMaker triangles(const Material &material = material_of(diffuse(0.5))) {
    SceneMaker maker(4, 1);
    maker.cube(maker.material(material));
    return maker;
}

Bsdf rough(BsdfKind kind, float alpha_u, float alpha_v) {
    Bsdf bsdf;
    bsdf.kind = kind;
    bsdf.alpha_u = alpha_u;
    bsdf.alpha_v = alpha_v;
    return bsdf;
}

TEST(Traits, AreThoseOfTheShapes) {
    SceneMaker maker = triangles();
    EXPECT_THAT(traits_of(maker.scene), ElementsAre("TRAIT_TRIANGLES"));
    maker.scene.meshes[0].normals.assign(maker.scene.meshes[0].positions.size(), {0, 0, 1});
    EXPECT_THAT(traits_of(maker.scene), UnorderedElementsAre("TRAIT_TRIANGLES", "TRAIT_SHADING_NORMALS"));

    SceneMaker spheres(4, 1);
    spheres.sphere({0, 0, 0}, 1, spheres.material(diffuse(0.5)));
    EXPECT_THAT(traits_of(spheres.scene), ElementsAre("TRAIT_SPHERES"));
}

TEST(Traits, AreThoseOfTheMaterials) {
    EXPECT_THAT(traits_of(triangles(two_sided(diffuse(0.5), diffuse(0.5))).scene),
                UnorderedElementsAre("TRAIT_TRIANGLES", "TRAIT_TWO_SIDED"));
    EXPECT_THAT(traits_of(triangles(two_sided(diffuse(0.5), diffuse(0.4))).scene),
                UnorderedElementsAre("TRAIT_TRIANGLES", "TRAIT_TWO_SIDED", "TRAIT_TWO_FACED"));
    EXPECT_THAT(traits_of(triangles(material_of(rough(BsdfKind::roughconductor_ggx, 0.1f, 0.1f))).scene),
                UnorderedElementsAre("TRAIT_TRIANGLES"));
    EXPECT_THAT(traits_of(triangles(material_of(rough(BsdfKind::roughconductor_ggx, 0.1f, 0.2f))).scene),
                UnorderedElementsAre("TRAIT_TRIANGLES", "TRAIT_ANISOTROPIC"));
    EXPECT_THAT(traits_of(triangles(material_of(rough(BsdfKind::roughdielectric_ggx, 0.1f, 0.2f))).scene),
                UnorderedElementsAre("TRAIT_TRIANGLES", "TRAIT_ANISOTROPIC", "TRAIT_REFRACTION"));
    EXPECT_THAT(traits_of(triangles(material_of(rough(BsdfKind::dielectric, 0.1f, 0.2f))).scene),
                UnorderedElementsAre("TRAIT_TRIANGLES", "TRAIT_REFRACTION"))
        << "a smooth material has no roughness";
    // The back counts where it can be seen, and only there.
    EXPECT_THAT(traits_of(triangles(two_sided(diffuse(0.5), rough(BsdfKind::roughconductor_ggx, 0.1f, 0.2f))).scene),
                UnorderedElementsAre("TRAIT_TRIANGLES", "TRAIT_TWO_SIDED", "TRAIT_TWO_FACED", "TRAIT_ANISOTROPIC"));
    Material one_sided = material_of(diffuse(0.5));
    one_sided.back = rough(BsdfKind::roughconductor_ggx, 0.1f, 0.2f);
    EXPECT_THAT(traits_of(triangles(one_sided).scene), ElementsAre("TRAIT_TRIANGLES"));
}

TEST(Traits, AreThoseOfTheLights) {
    const auto with = [](auto add) {
        SceneMaker maker = triangles();
        add(maker);
        std::set<std::string> traits = traits_of(maker.scene);
        EXPECT_EQ(traits.erase("TRAIT_TRIANGLES"), 1u);
        return traits;
    };
    const Rgb white{1, 1, 1};
    EXPECT_THAT(with([&](SceneMaker &m) { m.point_light(white, {}); }), ElementsAre("TRAIT_LIGHT_POINT"));
    EXPECT_THAT(with([&](SceneMaker &m) {
                    m.directional_light(white, {0, 0, 1});
                }),
                ElementsAre("TRAIT_LIGHT_DIRECTIONAL"));
    EXPECT_THAT(with([&](SceneMaker &m) { m.environment(1); }),
                UnorderedElementsAre("TRAIT_LIGHT_CONSTANT", "TRAIT_ENVIRONMENT"));
    EXPECT_THAT(with([&](SceneMaker &m) { m.environment(0); }), ElementsAre()) << "black";
    EXPECT_THAT(with([&](SceneMaker &m) { m.emitter(Emitter::Kind::environment, white); }),
                UnorderedElementsAre("TRAIT_LIGHT_ENVIRONMENT", "TRAIT_ENVIRONMENT"));
    EXPECT_THAT(with([&](SceneMaker &m) { m.emitter(Emitter::Kind::spot, white); }), ElementsAre("TRAIT_LIGHT_SPOT"));
    EXPECT_THAT(with([&](SceneMaker &m) { m.cube(0, m.emitter(Emitter::Kind::area, white)); }),
                ElementsAre("TRAIT_LIGHT_TRIANGLE"));
    EXPECT_THAT(with([&](SceneMaker &m) { m.sphere({}, 1, 0, m.emitter(Emitter::Kind::area, white)); }),
                UnorderedElementsAre("TRAIT_LIGHT_SPHERE", "TRAIT_SPHERES"));
}

TEST(Traits, AreThoseOfTheSettings) {
    SceneMaker maker = triangles();
    maker.scene.settings.hide_emitters = true;
    maker.scene.film.filter = FilmSettings::Filter::tent;
    EXPECT_THAT(traits_of(maker.scene), UnorderedElementsAre("TRAIT_TRIANGLES", "TRAIT_HIDE_EMITTERS", "TRAIT_FILTER"));
    maker.scene.settings.hide_emitters = false;
    maker.scene.film.filter = FilmSettings::Filter::gaussian;
    EXPECT_THAT(traits_of(maker.scene), UnorderedElementsAre("TRAIT_TRIANGLES", "TRAIT_FILTER"));
}

TEST(Traits, AllOnLeavesThePictureAlone) {
    const TraitMap special = scene_traits(triangles().scene), general = with_all_traits(special);
    ASSERT_EQ(general.size(), special.size());
    for (const auto &[name, value] : general)
        EXPECT_EQ(value, name.starts_with("TRAIT_FILTER") || name == "TRAIT_HIDE_EMITTERS" ||
                                 name.starts_with("TRAIT_TEXTURE") || name == "TRAIT_MATERIAL" ||
                                 name == "TRAIT_LOOKUPS" || name == "TRAIT_INDEXED" || name == "TRAIT_INSTANCES" ||
                                 name == "TRAIT_NORMAL_TEXTURES" || name == "TRAIT_LIGHT_TEXTURES" ||
                                 name.starts_with("TRAIT_BLEND")
                             ? special.at(name)
                             : 1)
            << name;
}

TEST(Traits, HaveDescriptions) {
    for (const auto &[name, value] : trait_list(triangles().scene))
        EXPECT_NE(trait_description(name), "") << name;
    EXPECT_EQ(trait_description("TRAIT_OF_NOTHING"), "");
}

TEST(BsdfKinds, AreThoseOfTheShapesInOneOrder) {
    SceneMaker maker(4, 1);
    const Bsdf glass = rough(BsdfKind::roughdielectric_ggx, 0.1f, 0.1f);
    maker.cube(maker.material(glass));
    maker.cube(maker.material(two_sided(diffuse(0.5), rough(BsdfKind::conductor, 0.1f, 0.1f))));
    maker.material(rough(BsdfKind::null, 0.1f, 0.1f)); // on no shape
    EXPECT_THAT(bsdf_kinds(maker.scene), ElementsAre("diffuse", "conductor", "roughdielectric_ggx"));
    EXPECT_TRUE(bsdf_kind_is_dirac("conductor"));
    EXPECT_TRUE(bsdf_kind_is_dirac("null"));
    EXPECT_FALSE(bsdf_kind_is_dirac("roughdielectric_ggx"));
}

// An index near 1 makes what passes narrow, whichever side it is told from; usual glass counts by its roughness.
TEST(Roughness, OfWhatPassesSaysWherePhotonsAreGathered) {
    for (const double ior : {1.31, 1.33, 1.5, 2.4, 1 / 1.33, 1 / 1.5})
        EXPECT_TRUE(gathers_photons(rough_glass(0.05, ior), 0.05)) << ior;
    EXPECT_FALSE(gathers_photons(rough_glass(0.049, 1.5), 0.05));
    for (const double ior : {1.002, 1 / 1.002, 1.0})
        for (const BsdfKind kind : {BsdfKind::roughdielectric_ggx, BsdfKind::roughdielectric_beckmann,
                                    BsdfKind::principled_clear, BsdfKind::principledthin}) {
            Bsdf bsdf = rough(kind, 0.9f, 0.9f);
            bsdf.ior = float(ior);
            EXPECT_EQ(gathers_photons(bsdf, 0.05), kind == BsdfKind::principledthin) << ior;
            EXPECT_TRUE(is_rough(bsdf, 0.05)) << "for shifts all is as it was";
        }
    // The share of a roughness that index 1.1 leaves is a third.
    EXPECT_TRUE(gathers_photons(rough_glass(0.16, 1.1), 0.05));
    EXPECT_FALSE(gathers_photons(rough_glass(0.14, 1.1), 0.05));
    // What passes leaves a thin sheet of this index mirrored, off microfacets of no roughness.
    Bsdf thin = rough(BsdfKind::principledthin, 0.9f, 0.9f);
    thin.ior = 0.54f;
    EXPECT_FALSE(gathers_photons(thin, 0.05));
    Bsdf opaque = rough(BsdfKind::principled, 0.05f, 0.05f);
    opaque.ior = 1.002f;
    EXPECT_TRUE(gathers_photons(opaque, 0.05)) << "nothing passes";
}

TEST(BsdfKinds, FollowFromTheirList) {
    // Each parameter that a kind names is a member of Bsdf, and each member is named by some kind.
    std::set<std::string> members, named;
#define GRADUS_MEMBER_NAME(with, name, value, text) members.insert(#name);
    GRADUS_MATERIAL_PARAMETERS(GRADUS_MEMBER_NAME, GRADUS_MEMBER_NAME, )
#undef GRADUS_MEMBER_NAME
    for (const std::string &name : all_bsdf_kinds()) {
        const BsdfKind kind = bsdf_kind_named(name);
        const BsdfKindTraits &traits = bsdf_kind_traits(kind);
        EXPECT_EQ(traits.name, name);
        named.insert(traits.parameters.begin(), traits.parameters.end());
        EXPECT_EQ(traits.refracts, name == "dielectric" || name.starts_with("roughdielectric") ||
                                       name == "principled_clear" || name == "principledthin")
            << name;
        EXPECT_EQ(traits.has_roughness, (name.starts_with("rough") && name != "roughdiffuse") || name == "phong" ||
                                            name == "ward" || name.starts_with("principled"))
            << name;
        EXPECT_EQ(traits.is_mixed, name == "plastic") << name;
        EXPECT_FALSE(traits.is_mixed && traits.is_dirac) << name;
    }
    EXPECT_EQ(members, named);
    EXPECT_TRUE(bsdf_kind_traits(BsdfKind::null).transmits);
    EXPECT_FALSE(bsdf_kind_traits(BsdfKind::null).refracts);
    EXPECT_FALSE(bsdf_kind_traits(BsdfKind::conductor).transmits);
    EXPECT_THROW(bsdf_kind_named("plaster"), std::out_of_range);
}

} // namespace
} // namespace gradus::testing
