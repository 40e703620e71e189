// BSDFs, emitters, sensor, film, filters and integrators in both dialects, value by value.
#include "runtime/io/image_io.h"
#include "runtime/scene/environment_map.h"
#include "tests/io/scene_text.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

namespace gradus {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Material material_of(const std::string &bsdf, const std::string &version = "3.0.0") {
    const LoadedScene loaded =
        load_text(scene_around("<shape type=\"cube\">" + bsdf + "</shape><emitter type=\"constant\"/>", version, ""));
    EXPECT_THAT(loaded.warnings, IsEmpty());
    return loaded.scene.materials.at(0);
}

Emitter emitter_of(const std::string &emitter, const std::string &version = "3.0.0") {
    const LoadedScene loaded = load_text(scene_around(emitter, version));
    EXPECT_THAT(loaded.warnings, IsEmpty());
    return loaded.scene.emitters.at(0);
}

Scene scene_with_sensor(const std::string &inside, const std::string &version = "3.0.0", const std::string &rest = "") {
    return load_text("<scene version=\"" + version + "\"><sensor type=\"perspective\">" + inside + "</sensor>" + rest +
                     "<shape type=\"cube\"/></scene>")
        .scene;
}

TEST(BsdfPlugin, DefaultIsDiffuseHalf) {
    const Material material = material_of("");
    EXPECT_EQ(material.front.kind, BsdfKind::diffuse);
    EXPECT_FALSE(material.two_sided);
    expect_rgb(material.front.reflectance, 0.5, 0.5, 0.5);
}

TEST(BsdfPlugin, Plastic) {
    const Bsdf smooth = material_of("<bsdf type=\"plastic\"/>").front;
    EXPECT_EQ(smooth.kind, BsdfKind::plastic);
    EXPECT_NEAR(smooth.ior, 1.49 / 1.000277, 1e-6);
    expect_rgb(smooth.reflectance, 0.5, 0.5, 0.5);
    expect_rgb(smooth.specular_reflectance, 1, 1, 1);
    EXPECT_EQ(smooth.nonlinear, 0.0f);
    // Egan and Hilgeman's fit (1973): -1.4399 / n^2 + 0.7099 / n + 0.6681 + 0.0636 n, to 0.1 %.
    const double n = smooth.ior;
    EXPECT_NEAR(smooth.internal_reflectance, -1.4399 / (n * n) + 0.7099 / n + 0.6681 + 0.0636 * n, 6e-4);
    const Bsdf rough = material_of("<bsdf type=\"roughplastic\"><float name=\"intIOR\" value=\"1.8\"/>"
                                   "<string name=\"distribution\" value=\"ggx\"/><float name=\"alpha\" "
                                   "value=\"0.3\"/><boolean name=\"nonlinear\" value=\"true\"/><rgb "
                                   "name=\"diffuseReflectance\" value=\"0.1 0.2 0.3\"/></bsdf>",
                                   "0.6.0")
                           .front;
    EXPECT_EQ(rough.kind, BsdfKind::roughplastic_ggx);
    EXPECT_EQ(rough.nonlinear, 1.0f);
    EXPECT_NEAR(rough.alpha_u, 0.3, 1e-6);
    expect_rgb(rough.reflectance, 0.1, 0.2, 0.3);
    EXPECT_EQ(material_of("<bsdf type=\"roughplastic\"/>").front.kind, BsdfKind::roughplastic_beckmann);
}

/// What follows from index and roughness is worked out once for each pair.
TEST(BsdfPlugin, CoatsAreEachMaterialsOwn) {
    const auto plastic = [](const std::string &distribution, const std::string &alpha, const std::string &ior) {
        return "<bsdf type=\"roughplastic\"><string name=\"distribution\" value=\"" + distribution +
               "\"/><float name=\"alpha\" value=\"" + alpha + "\"/><float name=\"int_ior\" value=\"" + ior +
               "\"/></bsdf>";
    };
    const std::vector<std::string> bsdfs = {plastic("ggx", "0.1", "1.5"), plastic("ggx", "0.4", "1.5"),
                                            plastic("ggx", "0.1", "1.8"), plastic("beckmann", "0.1", "1.5"),
                                            plastic("ggx", "0.1", "1.5")};
    std::string shapes;
    for (const std::string &bsdf : bsdfs)
        shapes += "<shape type=\"cube\">" + bsdf + "</shape>";
    const Scene all = load_text(scene_around(shapes)).scene;
    for (std::size_t i = 0; i < bsdfs.size(); ++i)
        EXPECT_EQ(all.materials.at(all.shapes.at(i).material).front, material_of(bsdfs[i]).front) << i;
    EXPECT_NE(all.materials.at(0).front.coat_1.value, all.materials.at(1).front.coat_1.value);
}

TEST(BsdfPlugin, ThinDielectric) {
    const Bsdf pane = material_of("<bsdf type=\"thindielectric\"><float name=\"int_ior\" value=\"1.6\"/>"
                                  "<float name=\"ext_ior\" value=\"1\"/></bsdf>")
                          .front;
    EXPECT_EQ(pane.kind, BsdfKind::thindielectric);
    EXPECT_NEAR(pane.pane_ior, 1.6, 1e-6);
}

// 0.6 keeps their hue, and takes the two of a phong together.
TEST(BsdfPlugin, ReflectancesAboveOneInOldFiles) {
    const auto loaded_as = [](const std::string &bsdf, const char *version) {
        return load_text(scene_around("<shape type=\"sphere\">\n" + bsdf + "</shape>", version, constant_light));
    };
    const std::string bright = "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"2 1 0.5\"/></bsdf>";
    LoadedScene loaded = loaded_as(bright, "0.6.0");
    expect_rgb(loaded.scene.materials[0].front.reflectance, 0.99, 0.495, 0.2475);
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("energy; scaled to 0.99")));
    loaded = loaded_as(bright, "3.0.0");
    expect_rgb(loaded.scene.materials[0].front.reflectance, 1, 1, 0.5);
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("energy; clamped to 1")));
    const std::string colors = "<rgb name=\"diffuseReflectance\" value=\"0.2\"/><rgb name=\"specularReflectance\" "
                               "value=\"9.8 4 1\"/>";
    loaded = loaded_as("<bsdf type=\"phong\">" + colors + "</bsdf>", "0.6.0");
    expect_rgb(loaded.scene.materials[0].front.reflectance, 0.0198, 0.0198, 0.0198);
    expect_rgb(loaded.scene.materials[0].front.specular_reflectance, 0.9702, 0.396, 0.099);
    EXPECT_TRUE(loaded.warnings.empty());
    const std::string each = "<boolean name=\"ensureEnergyConservation\" value=\"false\"/>";
    loaded = loaded_as("<bsdf type=\"phong\">" + each + colors + "</bsdf>", "0.6.0");
    expect_rgb(loaded.scene.materials[0].front.reflectance, 0.2, 0.2, 0.2);
    EXPECT_NEAR(loaded.scene.materials[0].front.specular_reflectance.r, 0.99, 1e-6);
    EXPECT_TRUE(loaded_as("<bsdf type=\"plastic\">" + each + "</bsdf>", "0.6.0").warnings.empty());
    EXPECT_THAT(loaded_as("<bsdf type=\"plastic\">" + each + "</bsdf>", "3.0.0").warnings,
                ElementsAre(HasSubstr("unknown parameter \"ensureEnergyConservation\"")));
}

TEST(BsdfPlugin, KindsOfOldFiles) {
    const Bsdf facets = material_of("<bsdf type=\"roughdiffuse\"><float name=\"alpha\" value=\"0.4\"/><boolean "
                                    "name=\"useFastApprox\" value=\"true\"/></bsdf>",
                                    "0.6.0")
                            .front;
    EXPECT_EQ(facets.kind, BsdfKind::roughdiffuse);
    EXPECT_NEAR(facets.facet_alpha, 0.4, 1e-6);
    EXPECT_EQ(facets.fast_approximation, 1.0f);
    const Bsdf phong = material_of("<bsdf type=\"phong\"><float name=\"exponent\" value=\"98\"/><rgb "
                                   "name=\"diffuseReflectance\" value=\"0.9\"/><rgb name=\"specularReflectance\" "
                                   "value=\"0.3\"/></bsdf>",
                                   "0.5.0")
                           .front;
    EXPECT_EQ(phong.kind, BsdfKind::phong);
    EXPECT_EQ(phong.exponent, 98.0f);
    EXPECT_NEAR(phong.alpha_u, std::sqrt(0.02), 1e-6);
    expect_rgb(phong.reflectance, 0.9 * 0.99 / 1.2, 0.9 * 0.99 / 1.2, 0.9 * 0.99 / 1.2);
    expect_rgb(phong.specular_reflectance, 0.3 * 0.99 / 1.2, 0.3 * 0.99 / 1.2, 0.3 * 0.99 / 1.2);
    for (const auto &[variant, number] : {std::pair{"ward", 0.0f}, {"ward-duer", 1.0f}, {"balanced", 2.0f}}) {
        const Bsdf ward = material_of("<bsdf type=\"ward\"><string name=\"variant\" value=\"" + std::string(variant) +
                                          "\"/><float name=\"alphaU\" value=\"0.3\"/></bsdf>",
                                      "0.6.0")
                              .front;
        EXPECT_EQ(ward.kind, BsdfKind::ward);
        EXPECT_EQ(ward.ward_variant, number);
        EXPECT_NEAR(ward.alpha_u, 0.3, 1e-6);
        EXPECT_NEAR(ward.alpha_v, 0.1, 1e-6);
        expect_rgb(ward.specular_reflectance, 0.2, 0.2, 0.2);
    }
}

TEST(BsdfPlugin, Principled) {
    const Bsdf plain = material_of("<bsdf type=\"principled\"/>").front;
    EXPECT_EQ(plain.kind, BsdfKind::principled);
    EXPECT_NEAR(plain.ior, 1.5, 1e-6); // specular 0.5
    EXPECT_NEAR(plain.alpha_u, 0.25, 1e-6);
    const Bsdf clear = material_of("<bsdf type=\"principled\"><float name=\"spec_trans\" value=\"0.3\"/><float "
                                   "name=\"eta\" value=\"1\"/><float name=\"anisotropic\" value=\"1\"/></bsdf>")
                           .front;
    EXPECT_EQ(clear.kind, BsdfKind::principled_clear);
    EXPECT_NEAR(clear.ior, 1.001, 1e-6);
    EXPECT_NEAR(clear.alpha_v, 0.25 * std::sqrt(0.1), 1e-6);
    const Bsdf thin =
        material_of("<bsdf type=\"principledthin\"><float name=\"diff_trans\" value=\"2\"/></bsdf>").front;
    EXPECT_EQ(thin.kind, BsdfKind::principledthin);
    EXPECT_EQ(thin.diff_trans, 2.0f);
    EXPECT_NEAR(thin.ior, 1.5, 1e-6);
}

/// Two alphas that differ are what asks for dp/du; the least is what tells rough surfaces from others. Of a texture
/// both hold for whatever it holds.
TEST(BsdfPlugin, PrincipledIsAnisotropicWhereATextureIs) {
    const auto with = [](const std::string &parameters) {
        return material_of("<bsdf type=\"principled\">" + parameters + "</bsdf>").front;
    };
    const auto number = [](const std::string &name, const std::string &value) {
        return "<float name=\"" + name + "\" value=\"" + value + "\"/>";
    };
    const auto board = [&](const std::string &name, const std::string &low, const std::string &high) {
        return "<texture name=\"" + name + "\" type=\"checkerboard\">" + number("color0", low) +
               number("color1", high) + "</texture>";
    };
    const Bsdf turned = with(number("roughness", "0.4") + board("anisotropic", "0", "0.9"));
    EXPECT_NEAR(turned.alpha_v, 0.16 * std::sqrt(0.19), 1e-6);
    EXPECT_GT(turned.alpha_u, 0.16);
    const Bsdf nearly_smooth = with(board("roughness", "0.01", "0.4") + number("anisotropic", "0.8"));
    EXPECT_NEAR(nearly_smooth.alpha_v, 0.001, 1e-6);
    EXPECT_GT(nearly_smooth.alpha_u, 0.1);
    const Bsdf round = with(board("roughness", "0.1", "0.4"));
    EXPECT_NEAR(round.alpha_u, 0.01, 1e-6);
    EXPECT_EQ(round.alpha_u, round.alpha_v);
}

TEST(BsdfPlugin, TwoSidesOfOtherKinds) {
    const Material sides =
        material_of("<bsdf type=\"twosided\"><bsdf type=\"principled\"/><bsdf type=\"plastic\"/></bsdf>");
    EXPECT_TRUE(sides.two_sided);
    EXPECT_EQ(sides.front.kind, BsdfKind::principled);
    EXPECT_EQ(sides.back.kind, BsdfKind::plastic);
    for (const char *kind : {"roughplastic", "roughdiffuse", "phong", "ward"})
        EXPECT_TRUE(material_of("<bsdf type=\"twosided\"><bsdf type=\"" + std::string(kind) + "\"/></bsdf>").two_sided)
            << kind;
    EXPECT_THROW(material_of("<bsdf type=\"twosided\"><bsdf type=\"thindielectric\"/></bsdf>"), Error);
    EXPECT_THROW(material_of("<bsdf type=\"twosided\"><bsdf type=\"principledthin\"/></bsdf>"), Error);
    const std::string inner = "<bsdf type=\"twosided\"><bsdf type=\"conductor\"/><bsdf type=\"diffuse\"/></bsdf>";
    const Material wrapped = material_of("<bsdf type=\"twosided\">" + inner + "</bsdf>");
    EXPECT_TRUE(wrapped.two_sided);
    EXPECT_EQ(wrapped.front.kind, BsdfKind::conductor);
    EXPECT_EQ(wrapped.back.kind, BsdfKind::conductor);
    EXPECT_THROW(material_of("<bsdf type=\"twosided\">" + inner + "<bsdf type=\"diffuse\"/></bsdf>"), Error);
}

/// Mitsuba's image is that without twosided where both sides are alike; else it has light enter by both sides.
TEST(BsdfPlugin, TwoSidesThatLetLightThrough) {
    const std::string allows = "<boolean name=\"allow_transmission\" value=\"true\"/>";
    const auto twosided = [](const std::string &inside) { return "<bsdf type=\"twosided\">" + inside + "</bsdf>"; };
    for (const std::string kind : {"thindielectric", "principledthin", "null"}) {
        const std::string nested = "<bsdf type=\"" + kind + "\"/>";
        const Material alone = material_of(nested), both = material_of(twosided(allows + nested));
        EXPECT_EQ(both.front, alone.front) << kind;
        EXPECT_FALSE(both.two_sided) << kind;
        EXPECT_THROW(material_of(twosided(nested)), Error) << kind;
    }
    EXPECT_TRUE(material_of(twosided(allows + "<bsdf type=\"diffuse\"/>")).two_sided);
    for (const std::string kind : {"dielectric", "roughdielectric"})
        EXPECT_THAT(error_of_text(scene_around("<shape type=\"cube\">" +
                                               twosided(allows + "<bsdf type=\"" + kind + "\"/>") + "</shape>")),
                    HasSubstr("leave twosided away"));
    EXPECT_THROW(material_of(twosided(allows + "<bsdf type=\"thindielectric\"/><bsdf type=\"diffuse\"/>")), Error);
    EXPECT_THROW(material_of(twosided(allows + "<bsdf type=\"bumpmap\"><texture type=\"mesh_attribute\"/><bsdf "
                                               "type=\"thindielectric\"/></bsdf>")),
                 Error);
}

TEST(BsdfPlugin, DistributionsOf0xAreReadAsBeckmann) {
    for (const std::string name : {"phong", "as"}) {
        const LoadedScene loaded = load_text(
            scene_around("<shape type=\"cube\"><bsdf type=\"roughdielectric\"><string name=\"distribution\" value=\"" +
                             name + "\"/></bsdf></shape><emitter type=\"constant\"/>",
                         "0.6.0", ""));
        EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("\"" + name + "\" is read as beckmann")));
        EXPECT_EQ(loaded.scene.materials.at(0).front.kind, BsdfKind::roughdielectric_beckmann);
    }
}

TEST(BsdfPlugin, NamesTheNearestOfKindsThatAreNotThere) {
    for (const auto &[kind, near] :
         {std::pair{"coating", "plastic"}, {"difftrans", "principledthin"}, {"hk", "principledthin"}}) {
        const LoadedScene loaded = load_text(scene_around("<bsdf type=\"" + std::string(kind) + "\"/>", "0.6.0"));
        EXPECT_THAT(loaded.warnings, Contains(HasSubstr(near))) << kind;
    }
}

Scene cube_scene(const std::string &bsdf) {
    return load_text(scene_around("<shape type=\"cube\">" + bsdf + "</shape><emitter type=\"constant\"/>", "3.0.0", ""))
        .scene;
}

TEST(BsdfPlugin, MixturesAreBlendsInBlends) {
    const auto mixture = [](const std::string &weights) {
        std::string text = "<bsdf type=\"mixturebsdf\"><string name=\"weights\" value=\"" + weights + "\"/>";
        for (const char *albedo : {"0.1", "0.2", "0.3"})
            text += std::string("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"") + albedo + "\"/></bsdf>";
        return cube_scene(text + "</bsdf>");
    };
    // Share of each albedo.
    const auto shares = [](const Scene &scene) {
        std::map<float, double> found;
        const std::function<void(const Bsdf &, double)> add = [&](const Bsdf &bsdf, double share) {
            if (bsdf.blend == no_blend) {
                found[bsdf.reflectance.r] += share;
                return;
            }
            const gradus::Blend &blend = scene.blends.at(std::size_t(bsdf.blend));
            add(scene.blended.at(blend.first), share * (1 - blend.weight));
            add(scene.blended.at(blend.second), share * blend.weight);
        };
        add(scene.materials.at(0).front, 1);
        return found;
    };
    const std::map<float, double> whole = shares(mixture("0.5, 0.3; 0.2"));
    EXPECT_NEAR(whole.at(0.1f), 0.5, 1e-6);
    EXPECT_NEAR(whole.at(0.2f), 0.3, 1e-6);
    EXPECT_NEAR(whole.at(0.3f), 0.2, 1e-6);
    const std::map<float, double> lacking = shares(mixture("0.5 0 0.2"));
    EXPECT_EQ(lacking.size(), 3u);
    EXPECT_NEAR(lacking.at(0.1f), 0.5, 1e-6);
    EXPECT_NEAR(lacking.at(0.3f), 0.2, 1e-6);
    EXPECT_NEAR(lacking.at(0), 0.3, 1e-6);
    EXPECT_NEAR(shares(mixture("1 2 1")).at(0.2f), 0.5, 1e-6);
}

TEST(BsdfPlugin, Blend) {
    const std::string red = "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"1 0 0\"/></bsdf>";
    const std::string mirror = "<bsdf type=\"conductor\"/>", glass = "<bsdf type=\"dielectric\"/>";
    const auto blend = [](const std::string &inside) { return "<bsdf type=\"blendbsdf\">" + inside + "</bsdf>"; };
    const Scene plain = cube_scene(blend(red + mirror));
    ASSERT_EQ(plain.blends.size(), 1u);
    EXPECT_EQ(plain.materials.at(0).front.blend, 0);
    EXPECT_FALSE(plain.materials.at(0).two_sided);
    EXPECT_EQ(plain.blends[0].weight, 0.5f);
    EXPECT_EQ(plain.blended.at(plain.blends[0].first).reflectance.r, 1);
    EXPECT_EQ(plain.blended.at(plain.blends[0].second).kind, BsdfKind::conductor);
    const Scene weighted = cube_scene(blend("<float name=\"weight\" value=\"0.25\"/>" + mirror + glass));
    EXPECT_EQ(weighted.blends.at(0).weight, 0.25f);
    const Scene textured = cube_scene(blend("<texture name=\"weight\" type=\"checkerboard\"/>" + red + mirror));
    EXPECT_EQ(textured.blends.at(0).weight.texture, 0);
    // Both sides: of the blend, of a part, of both parts.
    const Scene around = cube_scene("<bsdf type=\"twosided\">" + blend(red + mirror) + "</bsdf>");
    EXPECT_TRUE(around.materials.at(0).two_sided);
    EXPECT_EQ(around.materials.at(0).back.blend, around.materials.at(0).front.blend);
    const Scene of_one = cube_scene(blend("<bsdf type=\"twosided\">" + red + "</bsdf>" + mirror));
    EXPECT_TRUE(of_one.materials.at(0).two_sided);
    const Blend &back = of_one.blends.at(std::size_t(of_one.materials.at(0).back.blend));
    EXPECT_EQ(of_one.blended.at(back.first).reflectance.r, 1);
    EXPECT_EQ(of_one.blended.at(back.second).reflectance, Color(0, 0, 0));
    const Scene nested = cube_scene(blend(blend(red + mirror) + glass));
    EXPECT_EQ(nested.blended.at(nested.blends.at(1).first).blend, 0);
    EXPECT_THAT(error_of_text(scene_around("<shape type=\"cube\">" + blend(red) + "</shape>")),
                HasSubstr("blendbsdf needs two nested BSDFs, not 1"));
    EXPECT_THAT(error_of_text(scene_around("<shape type=\"cube\">" +
                                           blend("<bsdf type=\"twosided\">" + red + "</bsdf>" + glass) + "</shape>")),
                HasSubstr("lets light through is not supported"));
    EXPECT_THAT(error_of_text(scene_around("<shape type=\"cube\"><bsdf type=\"twosided\">" + blend(red + glass) +
                                           "</bsdf></shape>")),
                HasSubstr("twosided cannot hold a BSDF that lets light through"));
}

TEST(BsdfPlugin, Diffuse) {
    expect_rgb(material_of("<bsdf type=\"diffuse\"/>").front.reflectance, 0.5, 0.5, 0.5);
    expect_rgb(material_of("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\" .8,.4 , 0.2\"/></bsdf>")
                   .front.reflectance,
               0.8, 0.4, 0.2);
    expect_rgb(material_of("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.2\"/></bsdf>").front.reflectance,
               0.2, 0.2, 0.2);
    expect_rgb(
        material_of("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"#ff8000\"/></bsdf>").front.reflectance, 1,
        128 / 255.0, 0);
    expect_rgb(material_of("<bsdf type=\"diffuse\"><srgb name=\"reflectance\" value=\"0.5 1 0\"/></bsdf>", "0.6.0")
                   .front.reflectance,
               0.2140411, 1, 0);
    expect_rgb(
        material_of("<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"0.3\"/></bsdf>").front.reflectance,
        0.3, 0.3, 0.3);
    expect_rgb(
        material_of("<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"0.1 0.2 0.3\"/></bsdf>", "0.5.0")
            .front.reflectance,
        0.1, 0.2, 0.3);
    expect_rgb(material_of("<bsdf type=\"diffuse\"><spectrum name=\"diffuseReflectance\" value=\"300: 0.6, "
                           "900:0.6\"/></bsdf>",
                           "0.5.0")
                   .front.reflectance,
               0.6, 0.6, 0.6);
}

TEST(BsdfPlugin, ReflectanceAboveOneIsClampedWithAWarning) {
    const LoadedScene loaded =
        load_text(scene_around("<shape type=\"cube\"><bsdf type=\"diffuse\">\n<rgb name=\"reflectance\" "
                               "value=\"1.5 0.5 0.5\"/></bsdf></shape><emitter type=\"constant\"/>",
                               "3.0.0", ""));
    expect_rgb(loaded.scene.materials[0].front.reflectance, 1, 0.5, 0.5);
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("scene.xml:4")));
}

TEST(BsdfPlugin, Dielectric) {
    const Material plain = material_of("<bsdf type=\"dielectric\"/>");
    EXPECT_EQ(plain.front.kind, BsdfKind::dielectric);
    EXPECT_FLOAT_EQ(plain.front.ior, float(1.5046 / 1.000277));
    const Material named = material_of("<bsdf type=\"dielectric\"><string name=\"intIOR\" value=\"diamond\"/>"
                                       "<float name=\"extIOR\" value=\"1.5\"/>"
                                       "<rgb name=\"specularReflectance\" value=\"0.9\"/>"
                                       "<rgb name=\"specularTransmittance\" value=\"0.8\"/></bsdf>",
                                       "0.6.0");
    EXPECT_FLOAT_EQ(named.front.ior, float(2.419 / 1.5));
    expect_rgb(named.front.specular_reflectance, 0.9, 0.9, 0.9);
    expect_rgb(named.front.specular_transmittance, 0.8, 0.8, 0.8);
}

TEST(BsdfPlugin, RoughDielectric) {
    const Material material = material_of("<bsdf type=\"roughdielectric\"><string name=\"int_ior\" value=\"acrylic "
                                          "glass\"/><string name=\"ext_ior\" value=\"air\"/><float name=\"alpha\" "
                                          "value=\"0.05\"/><string name=\"distribution\" value=\"ggx\"/></bsdf>");
    EXPECT_EQ(material.front.kind, BsdfKind::roughdielectric_ggx);
    EXPECT_FLOAT_EQ(material.front.ior, float(1.49 / 1.000277));
    EXPECT_FLOAT_EQ(material.front.alpha_u, 0.05f);
    EXPECT_FLOAT_EQ(material.front.alpha_v, 0.05f);
}

TEST(BsdfPlugin, Conductor) {
    const Material mirror = material_of("<bsdf type=\"conductor\"/>");
    EXPECT_EQ(mirror.front.kind, BsdfKind::conductor);
    expect_rgb(mirror.front.eta, 0, 0, 0);
    expect_rgb(mirror.front.k, 1, 1, 1);
    const Material aluminium = material_of("<bsdf type=\"conductor\"><string name=\"material\" value=\"Al\"/></bsdf>");
    expect_rgb(aluminium.front.eta, 1.6575, 0.8804, 0.5212, 1e-3);
    expect_rgb(aluminium.front.k, 9.2238, 6.2695, 4.837, 1e-3);
    const Material given = material_of("<bsdf type=\"conductor\"><rgb name=\"eta\" value=\"0.2 0.9 1.1\"/><rgb "
                                       "name=\"k\" value=\"3.9 2.4 2.1\"/><float name=\"specular_reflectance\" "
                                       "value=\"0.3\"/></bsdf>");
    expect_rgb(given.front.eta, 0.2, 0.9, 1.1);
    expect_rgb(given.front.k, 3.9, 2.4, 2.1);
    expect_rgb(given.front.specular_reflectance, 0.3, 0.3, 0.3);
    const Material large = material_of("<bsdf type=\"conductor\"><rgb name=\"eta\" value=\"1 1e10 1e30\"/><rgb "
                                       "name=\"k\" value=\"1e38 2 1e8\"/></bsdf>");
    expect_rgb(large.front.eta, 1, 1e8, 1e8); // larger ones reflect no more, and no float holds what they come to
    expect_rgb(large.front.k, 1e8, 2, 1e8);
}

TEST(BsdfPlugin, ConductorsOfTheOldDialectStandInAirAndAreCopper) {
    const Material copper = material_of("<bsdf type=\"conductor\"/>", "0.6.0");
    expect_rgb(copper.front.eta, 0.201005 / 1.000277, 0.92375 / 1.000277, 1.10222 / 1.000277);
    const Material given = material_of("<bsdf type=\"conductor\"><spectrum name=\"eta\" value=\"2\"/><spectrum "
                                       "name=\"k\" value=\"4\"/><float name=\"extEta\" value=\"2\"/></bsdf>",
                                       "0.6.0");
    expect_rgb(given.front.eta, 1, 1, 1);
    expect_rgb(given.front.k, 2, 2, 2);
    const Material mirror =
        material_of("<bsdf type=\"conductor\"><string name=\"material\" value=\"none\"/></bsdf>", "0.6.0");
    expect_rgb(mirror.front.eta, 0, 0, 0, 0);
    expect_rgb(mirror.front.k, 1, 1, 1, 0);
}

/// As Mitsuba 3.9 and 0.6 have it.
TEST(BsdfPlugin, ConductorsByOneIndex) {
    const auto metal = [](const std::string &inside, const std::string &version = "3.0.0") {
        return material_of("<bsdf type=\"conductor\">" + inside + "</bsdf>", version).front;
    };
    const std::string eta = "<rgb name=\"eta\" value=\"0.2 0.9 1.1\"/>", k = "<rgb name=\"k\" value=\"3 2.4 2.1\"/>",
                      none = "<string name=\"material\" value=\"none\"/>";
    for (const std::string &both : {eta + k, none + eta + k}) {
        expect_rgb(metal(both).eta, 0.2, 0.9, 1.1);
        expect_rgb(metal(both).k, 3, 2.4, 2.1);
    }
    expect_rgb(metal(eta).eta, 0.2, 0.9, 1.1);
    expect_rgb(metal(eta).k, 1, 1, 1);
    expect_rgb(metal(k).eta, 0, 0, 0);
    expect_rgb(metal(k).k, 3, 2.4, 2.1);
    const std::string vacuum = "<float name=\"extEta\" value=\"1\"/>";
    const Bsdf copper = metal(vacuum, "0.6.0"), of_copper = metal(vacuum + eta, "0.6.0"),
               aluminium = metal(vacuum + "<string name=\"material\" value=\"Al\"/>" + k, "0.6.0");
    expect_rgb(of_copper.eta, 0.2, 0.9, 1.1);
    EXPECT_EQ(of_copper.k, copper.k);
    EXPECT_NEAR(aluminium.eta.r, 1.6575, 1e-3);
    expect_rgb(aluminium.k, 3, 2.4, 2.1);
}

TEST(BsdfPlugin, RoughConductor) {
    const Material plain = material_of("<bsdf type=\"roughconductor\"/>");
    EXPECT_EQ(plain.front.kind, BsdfKind::roughconductor_beckmann);
    EXPECT_FLOAT_EQ(plain.front.alpha_u, 0.1f);
    const Material brushed = material_of("<bsdf type=\"roughconductor\"><string name=\"distribution\" value=\"GGX\"/>"
                                         "<float name=\"alphaU\" value=\"0.2\"/><float name=\"alphaV\" "
                                         "value=\"0.00001\"/></bsdf>",
                                         "0.6.0");
    EXPECT_EQ(brushed.front.kind, BsdfKind::roughconductor_ggx);
    EXPECT_FLOAT_EQ(brushed.front.alpha_u, 0.2f);
    EXPECT_FLOAT_EQ(brushed.front.alpha_v, 1e-4f);
}

TEST(BsdfPlugin, SmoothKindsIgnoreRoughness) {
    for (const char *kind : {"conductor", "dielectric"})
        material_of(std::string("<bsdf type=\"") + kind + "\"><float name=\"alpha\" value=\"0.3\"/></bsdf>");
}

TEST(BsdfPlugin, TwoSided) {
    const Material one = material_of("<bsdf type=\"twosided\"><bsdf type=\"roughconductor\"/></bsdf>");
    EXPECT_TRUE(one.two_sided);
    EXPECT_EQ(one.front, one.back);
    EXPECT_EQ(one.front.kind, BsdfKind::roughconductor_beckmann);
    const Material two = material_of("<bsdf type=\"twosided\"><bsdf type=\"diffuse\"><float name=\"reflectance\" "
                                     "value=\"0.1\"/></bsdf><bsdf type=\"conductor\"/></bsdf>");
    EXPECT_TRUE(two.two_sided);
    EXPECT_EQ(two.front.kind, BsdfKind::diffuse);
    EXPECT_EQ(two.back.kind, BsdfKind::conductor);
}

TEST(BsdfPlugin, Null) { EXPECT_EQ(material_of("<bsdf type=\"null\"/>").front.kind, BsdfKind::null); }

TEST(BsdfPlugin, Mask) {
    const std::string nested = "<bsdf type=\"twosided\"><bsdf type=\"diffuse\"/></bsdf></bsdf>";
    EXPECT_FLOAT_EQ(material_of("<bsdf type=\"mask\">" + nested).opacity, 0.5f);
    const Material material = material_of("<bsdf type=\"mask\"><float name=\"opacity\" value=\"0.3\"/>" + nested);
    EXPECT_FLOAT_EQ(material.opacity, 0.3f);
    EXPECT_TRUE(material.two_sided);
    const Material textured =
        material_of("<bsdf type=\"mask\"><texture name=\"opacity\" type=\"checkerboard\"/>" + nested);
    EXPECT_EQ(textured.opacity.texture, 0);
}

// Rays must meet both masks, or the mask of the part of a blend that they meet.
TEST(BsdfPlugin, MasksInMasksAndBlends) {
    const std::string red = "<bsdf type='diffuse'><rgb name='reflectance' value='0.7 0.1 0.1'/></bsdf>",
                      mirror = "<bsdf type='roughconductor'/>";
    const auto mask = [](const std::string &opacity, const std::string &nested) {
        return "<bsdf type='mask'><float name='opacity' value='" + opacity + "'/>" + nested + "</bsdf>";
    };
    const std::string board = "<texture name='opacity' type='checkerboard'/>";
    const auto textured = [&](const std::string &nested) { return "<bsdf type='mask'>" + board + nested + "</bsdf>"; };
    const auto blend = [](const std::string &weight, const std::string &parts) {
        return "<bsdf type='blendbsdf'><float name='weight' value='" + weight + "'/>" + parts + "</bsdf>";
    };
    const auto loaded = [](const std::string &bsdf) {
        return load_text(scene_around("<shape type='cube'>" + bsdf + "</shape><emitter type='constant'/>", "3.0.0", ""))
            .scene;
    };
    EXPECT_FLOAT_EQ(loaded(mask("0.5", mask("0.4", red))).materials.at(0).opacity, 0.2f);
    for (const std::string &bsdf : {mask("0.5", textured(red)), textured(mask("0.5", red))}) {
        const Scene scene = loaded(bsdf);
        const Number opacity = scene.materials.at(0).opacity;
        EXPECT_FLOAT_EQ(float(texture_value(scene.textures.at(std::size_t(opacity.texture)), 0.1, 0.1)[0]), 0.2f);
    }
    // An opacity above 1 is 1, of which the other mask takes its part.
    const std::string bright = "<texture name='opacity' type='checkerboard'><float name='color0' value='2'/></texture>";
    const Scene opaque = loaded(mask("0.5", "<bsdf type='mask'>" + bright + red + "</bsdf>"));
    const Texture &picture = opaque.textures.at(std::size_t(opaque.materials.at(0).opacity.texture));
    EXPECT_FLOAT_EQ(float(texture_value(picture, 0.1, 0.1)[0]), 0.5f);
    // 0.7 of 0.5, and 0.3 of 0.2.
    const Scene numbers = loaded(blend("0.3", mask("0.5", red) + mask("0.2", mirror)));
    EXPECT_FLOAT_EQ(numbers.materials.at(0).opacity, 0.41f);
    EXPECT_FLOAT_EQ(numbers.blends.at(0).weight, 0.06f / 0.41f);
    EXPECT_EQ(numbers.materials.at(0).front.blend, 0);
    const Scene alike = loaded(blend("0.3", mask("0.5", red) + mask("0.5", mirror)));
    EXPECT_FLOAT_EQ(alike.materials.at(0).opacity, 0.5f);
    EXPECT_FLOAT_EQ(alike.blends.at(0).weight, 0.3f);
    // One texture for both: the blend has its holes.
    const std::string named = "<bsdf type='mask'><ref name='opacity' id='t'/>";
    const Scene holes =
        load_text(scene_around("<texture type='checkerboard' id='t'/><shape type='cube'>" +
                               blend("0.3", named + red + "</bsdf>" + named + mirror + "</bsdf>") + "</shape>"))
            .scene;
    EXPECT_EQ(holes.materials.at(holes.shapes.front().material).opacity.texture, 0);
    EXPECT_EQ(holes.blends.size(), 1u);
}

// Light passes them as if they were not there, so they are not; but for those that shine.
TEST(BsdfPlugin, SurfacesThatNoRayMeetsAreLeftOut) {
    const std::string never =
        "<bsdf type=\"mask\"><float name=\"opacity\" value=\"0\"/><bsdf type=\"diffuse\"/></bsdf>";
    const std::string lamp = "<emitter type=\"area\"/>";
    const LoadedScene loaded =
        load_text(scene_around("<shape type=\"cube\"><bsdf type=\"null\"/></shape><shape type=\"cube\" id=\"a\">" +
                               never + lamp + "</shape><shape type=\"cube\">" + never + "</shape>"));
    EXPECT_EQ(loaded.scene.shapes.size(), 2u); // with that of scene_around()
    EXPECT_NE(std::ranges::find(loaded.scene.shapes, "a", &Shape::name), loaded.scene.shapes.end());
    ASSERT_EQ(loaded.warnings.size(), 1u);
    EXPECT_NE(loaded.warnings[0].find("emits: its opacity is taken as 1"), std::string::npos);
}

TEST(EmitterPlugin, Area) {
    const LoadedScene loaded =
        load_text(scene_around("<shape type=\"rectangle\" id=\"lamp\"><emitter type=\"area\"><rgb "
                               "name=\"radiance\" value=\"17, 12, 4\"/></emitter></shape>"));
    ASSERT_EQ(loaded.scene.emitters.size(), 1u);
    EXPECT_EQ(loaded.scene.emitters[0].kind, Emitter::Kind::area);
    expect_rgb(loaded.scene.emitters[0].value, 17, 12, 4);
    EXPECT_EQ(loaded.scene.shapes[0].emitter, 0);
    EXPECT_EQ(loaded.scene.shapes[0].name, "lamp");
    EXPECT_EQ(loaded.scene.shapes[1].emitter, -1);
}

TEST(EmitterPlugin, BlackLightIsNoLight) {
    const LoadedScene loaded = load_text(scene_around("<shape type=\"rectangle\"><emitter type=\"area\"><rgb "
                                                      "name=\"radiance\" value=\"0\"/></emitter></shape>"));
    EXPECT_THAT(loaded.scene.emitters, IsEmpty());
    EXPECT_EQ(loaded.scene.shapes[0].emitter, -1);
}

TEST(EmitterPlugin, LightWithoutAreaIsDropped) {
    const LoadedScene loaded =
        load_text(scene_around("<shape type=\"rectangle\" id=\"flat\"><transform name=\"to_world\"><scale x=\"0\"/>"
                               "</transform><emitter type=\"area\"/></shape><emitter type=\"constant\"/>"));
    EXPECT_EQ(loaded.scene.emitters.size(), 1u);
    EXPECT_EQ(loaded.scene.shapes.size(), 1u);
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("2 degenerate triangles"), HasSubstr("\"flat\" has no area")));
}

// A square of 2e-7 at 0.5 was 9 % too bright, and one of 2e-8 more than twice as bright as it should be.
TEST(EmitterPlugin, LampsThatRoundingMakesLargerAreWarnedOf) {
    const auto warnings = [](const std::string &scale) {
        return load_text(
                   scene_around("<shape type=\"rectangle\" id=\"lamp\"><transform name=\"to_world\"><scale value=\"" +
                                scale + "\"/><translate x=\"0.5\"/></transform><emitter type=\"area\"/></shape>"))
            .warnings;
    };
    EXPECT_THAT(warnings("1e-4"), IsEmpty());
    EXPECT_THAT(warnings("1e-7"), ElementsAre(HasSubstr("\"lamp\" emits and is so narrow")));
    EXPECT_THAT(
        load_text(scene_around("<shape type=\"rectangle\" id=\"strip\"><transform name=\"to_world\"><scale "
                               "x=\"1e-7\"/><translate x=\"0.5\"/></transform><emitter type=\"area\"/></shape>"))
            .warnings,
        ElementsAre(HasSubstr("\"strip\" emits and is so narrow")));
}

TEST(EmitterPlugin, Constant) {
    const Emitter emitter =
        emitter_of("<emitter type=\"constant\"><spectrum name=\"radiance\" value=\"5000\"/></emitter>", "0.6.0");
    EXPECT_EQ(emitter.kind, Emitter::Kind::constant);
    expect_rgb(emitter.value, 5000, 5000, 5000);
    // From 2.0 on one number is equal energy at all wavelengths, as Mitsuba 3.9.1 renders it:
    // (2.40959, 1.89658, 1.81783).
    expect_rgb(emitter_of("<emitter type=\"constant\"><spectrum name=\"radiance\" value=\"2\"/></emitter>").value,
               2.40959, 1.89658, 1.81783, 2e-3);
    expect_rgb(emitter_of("<emitter type=\"constant\"><float name=\"radiance\" value=\"2\"/></emitter>").value, 2, 2,
               2);
    expect_rgb(emitter_of("<emitter type=\"constant\"/>").value, 1, 1, 1);
}

TEST(EmitterPlugin, Point) {
    const Emitter emitter = emitter_of("<emitter type=\"point\"><point name=\"position\" x=\"1\" y=\"2\" z=\"3\"/><rgb "
                                       "name=\"intensity\" value=\"4 5 6\"/></emitter>");
    EXPECT_EQ(emitter.kind, Emitter::Kind::point);
    expect_vector(emitter.position, 1, 2, 3);
    expect_rgb(emitter.value, 4, 5, 6);
    expect_vector(emitter_of("<emitter type=\"point\"><point name=\"position\" value=\"0.5\"/></emitter>").position,
                  0.5, 0.5, 0.5);
    const Emitter moved = emitter_of("<emitter type=\"point\"><transform name=\"toWorld\"><translate y=\"7\"/>"
                                     "</transform></emitter>",
                                     "0.5.0");
    expect_vector(moved.position, 0, 7, 0);
    expect_rgb(moved.value, 1, 1, 1);
}

TEST(EmitterPlugin, Directional) {
    const Emitter emitter = emitter_of("<emitter type=\"directional\"><vector name=\"direction\" value=\"0, 0, -2\"/>"
                                       "<rgb name=\"irradiance\" value=\"2, 2, 1.8\"/></emitter>");
    EXPECT_EQ(emitter.kind, Emitter::Kind::directional);
    expect_vector(emitter.direction, 0, 0, -1);
    expect_rgb(emitter.value, 2, 2, 1.8);
    // A quarter turn about y takes +z to +x.
    const Emitter turned = emitter_of("<emitter type=\"directional\"><transform name=\"to_world\"><rotate y=\"1\" "
                                      "angle=\"90\"/><scale value=\"5\"/></transform></emitter>");
    expect_vector(turned.direction, 1, 0, 0);
}

TEST(EmitterPlugin, Spot) {
    const Emitter plain = emitter_of("<emitter type=\"spot\"/>");
    EXPECT_EQ(plain.kind, Emitter::Kind::spot);
    expect_rgb(plain.value, 1, 1, 1);
    expect_vector(plain.position, 0, 0, 0);
    expect_vector(plain.direction, 0, 0, 1);
    constexpr double radians = 3.14159265358979 / 180;
    EXPECT_NEAR(plain.cutoff, 20 * radians, 1e-6);
    EXPECT_NEAR(plain.beam, 15 * radians, 1e-6);
    const Emitter turned =
        emitter_of("<emitter type=\"spot\"><rgb name=\"intensity\" value=\"1 2 3\"/><float name=\"cutoffAngle\" "
                   "value=\"40\"/><float name=\"beamWidth\" value=\"40\"/><transform name=\"toWorld\"><lookAt "
                   "origin=\"1 2 3\" target=\"1 -2 3\" up=\"1 0 0\"/></transform></emitter>",
                   "0.6.0");
    expect_rgb(turned.value, 1, 2, 3);
    expect_vector(turned.position, 1, 2, 3);
    expect_vector(turned.direction, 0, -1, 0);
    EXPECT_NEAR(turned.cutoff, 40 * radians, 1e-6);
    EXPECT_NEAR(turned.beam, 40 * radians, 1e-6);
    EXPECT_THAT(
        error_of_text(scene_around("<emitter type=\"spot\"><float name=\"beam_width\" value=\"30\"/></emitter>")),
        HasSubstr("wider than its cutoff_angle"));
}

/// Mitsuba's cone is as its to_world stretches it.
TEST(EmitterPlugin, SpotsAreNotStretched) {
    const auto warnings = [](const std::string &steps) {
        return load_text(scene_around("<emitter type=\"spot\"><transform name=\"to_world\">" + steps +
                                      "</transform></emitter>"))
            .warnings;
    };
    EXPECT_THAT(warnings("<scale x=\"2\"/>"), ElementsAre(HasSubstr("scene.xml:3: to_world turns and moves a spot")));
    EXPECT_THAT(warnings("<scale z=\"2\"/>"), ElementsAre(HasSubstr("that it stretches does not count")));
    EXPECT_THAT(warnings("<scale x=\"-3\" y=\"3\" z=\"3\"/><rotate x=\"1\" angle=\"30\"/><translate x=\"4\"/>"),
                IsEmpty());
}

TEST(EmitterPlugin, SpotWithAPicture) {
    for (const char *version : {"3.0.0", "0.6.0"}) {
        const std::string name = std::string(version) == "0.6.0" ? "" : " name=\"texture\"";
        const LoadedScene loaded = load_text(scene_around(
            "<emitter type=\"spot\"><float name=\"cutoff_angle\" value=\"45\"/><texture type=\"checkerboard\"" + name +
                "/><transform name=\"to_world\"><scale value=\"3\"/><rotate y=\"1\" "
                "angle=\"90\"/></transform></emitter>",
            version));
        EXPECT_THAT(loaded.warnings, IsEmpty());
        const Emitter &emitter = loaded.scene.emitters.at(0);
        EXPECT_EQ(emitter.kind, Emitter::Kind::spot);
        EXPECT_EQ(emitter.texture, 0);
        EXPECT_EQ(loaded.scene.textures.at(0).kind, Texture::Kind::checkerboard);
        expect_vector(emitter.axes[0], 0, 0, -1);
        expect_vector(emitter.axes[1], 0, 1, 0);
        expect_vector(emitter.direction, 1, 0, 0);
        EXPECT_NEAR(emitter.picture[0], 2, 1e-6);
        EXPECT_NEAR(emitter.picture[1], 2, 1e-6);
    }
    const auto error = [](const std::string &inside) {
        return error_of_text(scene_around("<emitter type=\"spot\">\n" + inside + "</emitter>"));
    };
    const std::string board = "<texture type=\"checkerboard\"/>";
    EXPECT_THAT(error(board + "<float name=\"cutoff_angle\" value=\"90\"/>"), HasSubstr("below 90 degrees"));
    EXPECT_THAT(error(board + board), HasSubstr("scene.xml:4: a spot has one texture"));
    EXPECT_THAT(error(board + "<transform name=\"to_world\"><scale x=\"2\"/></transform>"), HasSubstr("not stretched"));
    EXPECT_THAT(error("<texture type=\"checkerboard\" name=\"intensity\"/>"), HasSubstr("cannot be a texture"));
    EXPECT_THAT(error("<texture type=\"mesh_attribute\"><string name=\"name\" value=\"face_a\"/></texture>"),
                HasSubstr("scene.xml:4: a picture to throw cannot be a mesh attribute"));
}

TEST(EmitterPlugin, Projector) {
    const LoadedScene loaded = load_text(scene_around(
        "<emitter type=\"projector\"><texture type=\"checkerboard\" name=\"irradiance\"/><float name=\"scale\" "
        "value=\"2\"/><float name=\"fov\" value=\"90\"/><transform name=\"to_world\"><translate y=\"5\"/></transform>"
        "</emitter>"));
    EXPECT_THAT(loaded.warnings, IsEmpty());
    const Emitter &emitter = loaded.scene.emitters.at(0);
    EXPECT_EQ(emitter.kind, Emitter::Kind::projector);
    EXPECT_EQ(emitter.texture, 0);
    expect_rgb(emitter.value, 6.2831853, 6.2831853, 6.2831853);
    expect_vector(emitter.position, 0, 5, 0);
    expect_vector(emitter.axes[0], -1, 0, 0);
    expect_vector(emitter.axes[1], 0, -1, 0);
    expect_vector(emitter.direction, 0, 0, 1);
    EXPECT_NEAR(emitter.picture[0], 2, 1e-6);
    EXPECT_NEAR(emitter.picture[1], 2, 1e-6);
    // Of one colour, and by focal length: half a diagonal of 35 mm film over 100 mm, of a square.
    const Emitter plain = emitter_of("<emitter type=\"projector\"><rgb name=\"irradiance\" value=\"1 2 3\"/><string "
                                     "name=\"focal_length\" value=\"100mm\"/></emitter>");
    expect_rgb(plain.value, 3.14159265, 6.2831853, 9.42477796);
    EXPECT_EQ(plain.texture, no_texture);
    EXPECT_NEAR(plain.picture[0], 2 * std::hypot(18, 12) / 100 / std::sqrt(2.0), 1e-6);
    const auto error = [](const std::string &inside) {
        return error_of_text(scene_around("<emitter type=\"projector\">\n" + inside + "</emitter>"));
    };
    const std::string white = "<rgb name=\"irradiance\" value=\"1\"/>";
    EXPECT_THAT(error(""), HasSubstr("scene.xml:3: projector needs an irradiance"));
    EXPECT_THAT(error(white + "<transform name=\"to_world\"><scale value=\"2\"/></transform>"),
                HasSubstr("not stretched"));
    EXPECT_THAT(error(white + "<float name=\"fov\" value=\"180\"/>"), HasSubstr("between 0 and 180"));
    EXPECT_THAT(error(white + "<float name=\"scale\" value=\"-1\"/>"), HasSubstr("at least 0"));
    EXPECT_THAT(error("<texture type=\"mesh_attribute\" name=\"irradiance\"><string name=\"name\" "
                      "value=\"face_a\"/></texture>"),
                HasSubstr("scene.xml:4: a picture to throw cannot be a mesh attribute"));
}

TEST(EmitterPlugin, AreaOfATexture) {
    for (const char *version : {"3.0.0", "0.6.0"}) {
        const LoadedScene loaded = load_text(scene_around(
            "<texture type=\"checkerboard\" id=\"t\"><rgb name=\"color0\" value=\"7 8 9\"/></texture><shape "
            "type=\"rectangle\"><emitter type=\"area\"><ref id=\"t\" name=\"radiance\"/></emitter></shape>",
            version));
        EXPECT_THAT(loaded.warnings, IsEmpty());
        const Emitter &emitter = loaded.scene.emitters.at(0);
        expect_rgb(emitter.value, 1, 1, 1);
        EXPECT_EQ(emitter.texture, 0);
        EXPECT_EQ(texture_range(loaded.scene.textures.at(0)).most[2], 9); // not clamped
    }
    const LoadedScene black = load_text(scene_around(
        "<shape type=\"rectangle\"><emitter type=\"area\"><texture type=\"checkerboard\" name=\"radiance\"><rgb "
        "name=\"color0\" value=\"0\"/><rgb name=\"color1\" value=\"0\"/></texture></emitter></shape>"));
    EXPECT_TRUE(black.scene.emitters.empty());
    EXPECT_TRUE(black.scene.shapes.at(0).is_black_lamp);
    EXPECT_FALSE(black.scene.shapes.at(1).is_black_lamp);
    EXPECT_THAT(error_of_text(scene_around("<emitter type=\"point\"><texture type=\"checkerboard\" "
                                           "name=\"intensity\"/></emitter>")),
                HasSubstr("cannot be a texture"));
    EXPECT_THAT(error_of_text(scene_around("<shape type=\"sphere\"><emitter type=\"area\"><texture "
                                           "type=\"mesh_attribute\" name=\"radiance\"><string name=\"name\" "
                                           "value=\"face_a\"/></texture></emitter></shape>")),
                HasSubstr("has no attribute \"face_a\""));
}

/// An image of 3 x 2 texels beside the scene: of the colour (1, 2, 3), but the first texel, which is `first`.
LoadedScene load_with_map(const std::string &emitter, float first = 1, const std::string &version = "3.0.0") {
    TemporaryFolder folder;
    Image image;
    image.width = 3;
    image.height = 2;
    image.channels = {
        {"R", std::vector<float>(6, 1)}, {"G", std::vector<float>(6, 2)}, {"B", std::vector<float>(6, 3)}};
    image.channels[0].values[0] = first;
    write_image(image, (folder.path() / "sky.exr").string());
    return load_scene(folder.write("scene.xml", scene_around(emitter, version)));
}

const std::string sky_file = "<string name=\"filename\" value=\"sky.exr\"/>";

TEST(EmitterPlugin, EnvironmentMap) {
    const LoadedScene loaded = load_with_map("<emitter type=\"envmap\">" + sky_file + "</emitter>");
    EXPECT_THAT(loaded.warnings, IsEmpty());
    const Emitter &emitter = loaded.scene.emitters.at(0);
    EXPECT_EQ(emitter.kind, Emitter::Kind::environment);
    expect_rgb(emitter.value, 1, 1, 1);
    expect_vector(emitter.axes[0], 1, 0, 0);
    expect_vector(emitter.axes[2], 0, 0, 1);
    ASSERT_TRUE(emitter.map);
    EXPECT_EQ(emitter.map->columns, 3u);
    EXPECT_EQ(emitter.map->rows, 1u);
    const double sphere = 4 * 3.14159265358979;
    expect_rgb(emitter.map->integral, sphere, 2 * sphere, 3 * sphere, 1e-4);
    // Turned, mirrored, of any size; in 0.x, too.
    const LoadedScene turned = load_with_map(
        "<emitter type=\"envmap\">" + sky_file +
            "<float name=\"scale\" value=\"2.5\"/><float name=\"samplingWeight\" value=\"1\"/><transform "
            "name=\"toWorld\"><scale x=\"-3\" y=\"3\" z=\"3\"/><rotate y=\"1\" angle=\"90\"/></transform></emitter>",
        1, "0.6.0");
    EXPECT_THAT(turned.warnings, IsEmpty());
    expect_rgb(turned.scene.emitters.at(0).value, 2.5, 2.5, 2.5);
    expect_vector(turned.scene.emitters[0].axes[0], 0, 0, 1);
    expect_vector(turned.scene.emitters[0].axes[1], 0, 1, 0);
    expect_vector(turned.scene.emitters[0].axes[2], 1, 0, 0);
    // Of three digits.
    const LoadedScene rounded = load_with_map(
        "<emitter type=\"envmap\">" + sky_file +
        "<transform name=\"to_world\"><matrix value=\".707 0 .707 0 0 1 0 0 -.707 0 .707 0 0 0 0 1\"/></transform>"
        "</emitter>");
    expect_vector(rounded.scene.emitters.at(0).axes[0], std::sqrt(0.5), 0, -std::sqrt(0.5));
}

/// Of an environment of one texel with such channels, each of which is worth its place: 1, 2, 3...
LoadedScene load_with_channels(const std::vector<std::string> &names, std::uint32_t rows = 1) {
    TemporaryFolder folder;
    Image image;
    image.width = 1;
    image.height = rows;
    for (const std::string &name : names)
        image.channels.push_back({name, std::vector<float>(rows, float(image.channels.size() + 1))});
    write_image(image, (folder.path() / "sky.exr").string());
    return load_scene(folder.write("scene.xml", scene_around("<emitter type=\"envmap\">" + sky_file + "</emitter>")));
}

TEST(EmitterPlugin, EnvironmentMapsOfLayers) {
    const auto expect_channels = [](const std::vector<std::string> &names, double r, double g, double b) {
        const LoadedScene loaded = load_with_channels(names);
        const double sphere = 4 * 3.14159265358979;
        expect_rgb(loaded.scene.emitters.at(0).map->integral, r * sphere, g * sphere, b * sphere, 1e-3);
        return loaded.warnings;
    };
    EXPECT_THAT(expect_channels({"A", "B", "G", "R", "view.R"}, 4, 3, 2), IsEmpty());
    EXPECT_THAT(expect_channels({"b", "g", "r"}, 3, 2, 1), IsEmpty());
    EXPECT_THAT(expect_channels({"Layer.Combined.A", "Layer.Combined.B", "Layer.Combined.G", "Layer.Combined.R",
                                 "Layer.Depth.Z", "Layer.Mist.Y"},
                                4, 3, 2),
                IsEmpty());
    EXPECT_THAT(expect_channels({"a.B", "a.G", "a.R", "b.B", "b.G", "b.R"}, 3, 2, 1),
                ElementsAre(HasSubstr("2 layers that could be meant; it is that of the channel a.R")));
    EXPECT_THAT(expect_channels({"A", "Y"}, 2, 2, 2), IsEmpty());
    EXPECT_THAT(expect_channels({"light"}, 1, 1, 1), IsEmpty());
    EXPECT_THAT(expect_channels({"N.X", "N.Y", "N.Z", "Y"}, 4, 4, 4), IsEmpty());
    for (const std::vector<std::string> &names :
         {std::vector<std::string>{"X", "Z"}, {"X", "Y", "Z"}, {"R", "G"}, {"a.R", "b.G", "c.B"}})
        try {
            load_with_channels(names);
            ADD_FAILURE() << names[0];
        } catch (const Error &error) {
            EXPECT_THAT(error.what(), HasSubstr("sky.exr none are R, G, B or Y"));
        }
}

TEST(EmitterPlugin, EnvironmentMapsThatCannotBe) {
    const auto error_with_map = [](const std::string &inside) {
        try {
            load_with_map("<emitter type=\"envmap\">" + inside + "</emitter>");
        } catch (const Error &error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_THAT(error_with_map(""), HasSubstr("envmap needs a filename"));
    EXPECT_THAT(error_with_map("<string name=\"filename\" value=\"none.exr\"/>"),
                HasSubstr("scene.xml:3: cannot find the file \"none.exr\""));
    EXPECT_THAT(error_with_map("<string name=\"filename\" value=\"scene.xml\"/>"),
                HasSubstr("scene.xml:3: cannot read the image"));
    EXPECT_THAT(error_with_map(sky_file + "<transform name=\"to_world\"><scale x=\"2\"/></transform>"),
                HasSubstr("turned and mirrored, not stretched"));
    EXPECT_THAT(error_with_map(sky_file + "</emitter><emitter type=\"constant\">"),
                HasSubstr("a second environment emitter"));
    for (const char *type : {"sky", "sun", "sunsky"})
        EXPECT_THAT(error_of_text(scene_around("<emitter type=\"" + std::string(type) + "\"/>")),
                    HasSubstr("bake it into an image"));
}

// A file of a megabyte would take one of a gigabyte.
TEST(EmitterPlugin, EnvironmentMapsOfManyShortRows) {
    for (const std::uint32_t width : {1u, 63u, 64u, 256u, 257u, 1u << 20}) {
        const std::uint64_t rows = most_environment_rows(width), strips = rows * ((width + 255) / 256);
        EXPECT_LT(strips, 1u << 22) << width;
        EXPECT_LE(strips * 1024, std::max<std::uint64_t>(1u << 28, 16 * rows * width)) << width;
    }
    for (const std::uint32_t width : {512u, 8192u, 32768u}) // twice as wide as high, and square
        EXPECT_GE(most_environment_rows(width), std::min(std::uint64_t(width), most_environment_texels / width));
    try {
        load_with_channels({"Y"}, 262'145);
        ADD_FAILURE();
    } catch (const Error &error) {
        EXPECT_THAT(error.what(), HasSubstr("sky.exr has 1 x 262145 texels; so narrow a one may have 262144 rows"));
    }
}

TEST(EmitterPlugin, EnvironmentMapsWithBadTexels) {
    const std::string emitter = "<emitter type=\"envmap\">" + sky_file + "</emitter>";
    const float infinity = std::numeric_limits<float>::infinity();
    EXPECT_THAT(load_with_map(emitter, -2).warnings, ElementsAre(HasSubstr("1 negative values, which count as 0")));
    EXPECT_THAT(load_with_map(emitter, std::nanf("")).warnings,
                ElementsAre(HasSubstr("1 values that are not numbers")));
    const LoadedScene loaded = load_with_map(emitter, infinity);
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("1 infinite values, which count as its largest one, 3")));
    EXPECT_THAT(load_with_map(emitter, 3e38f).warnings, // whose sum over the sphere is infinite
                ElementsAre(HasSubstr("1 infinite values, which count as its largest one, 3")));
    EXPECT_THROW(
        load_with_map("<emitter type=\"envmap\">" + sky_file + "<float name=\"scale\" value=\"1e30\"/></emitter>",
                      1e30f),
        Error);
    // Five texels of 1, and one of 3: each has a sixth of the sphere.
    EXPECT_NEAR(loaded.scene.emitters.at(0).map->integral.r, 4 * 3.14159265358979 * 8 / 6, 1e-4);
    // A black one, by its scale, is no light.
    EXPECT_THAT(load_with_map("<emitter type=\"envmap\">" + sky_file + "<float name=\"scale\" value=\"0\"/></emitter>")
                    .scene.emitters,
                IsEmpty());
}

TEST(EmitterPlugin, AreaEmittersMayStandApart) {
    const LoadedScene loaded =
        load_text(scene_around("<emitter type=\"area\" id=\"glow\"><rgb name=\"radiance\" value=\"2\"/></emitter>"
                               "<shape type=\"rectangle\"><ref id=\"glow\"/></shape>"));
    EXPECT_THAT(loaded.warnings, IsEmpty());
    ASSERT_EQ(loaded.scene.emitters.size(), 1u);
    EXPECT_EQ(loaded.scene.shapes[0].emitter, 0);
}

TEST(SensorPlugin, FieldOfView) {
    const Scene both = scene_with_sensor("<float name=\"fov\" value=\"39.3\"/><string name=\"fovAxis\" "
                                         "value=\"Diagonal\"/>",
                                         "0.6.0");
    EXPECT_DOUBLE_EQ(both.camera.fov, 39.3);
    EXPECT_EQ(both.camera.fov_axis, Camera::FovAxis::diagonal);
    EXPECT_EQ(scene_with_sensor("<float name=\"fov\" value=\"39.3\"/>").camera.fov_axis, Camera::FovAxis::x);
    EXPECT_EQ(
        scene_with_sensor("<float name=\"fov\" value=\"9\"/><string name=\"fov_axis\" value=\"y\"/>").camera.fov_axis,
        Camera::FovAxis::y);
    EXPECT_EQ(scene_with_sensor("<float name=\"fov\" value=\"9\"/><string name=\"fov_axis\" value=\"larger\"/>")
                  .camera.fov_axis,
              Camera::FovAxis::larger);
}

TEST(SensorPlugin, FocalLengthIsThatOf35mmFilm) {
    // tan(fov / 2) = half the diagonal of 36 x 24 mm over the focal length.
    const Scene standard = scene_with_sensor("");
    EXPECT_EQ(standard.camera.fov_axis, Camera::FovAxis::diagonal);
    EXPECT_NEAR(std::tan(standard.camera.fov / 2 * 3.14159265358979 / 180), 21.633307652783937 / 50, 1e-9);
    const Scene wide = scene_with_sensor("<string name=\"focal_length\" value=\"21.633307652783937mm\"/>");
    EXPECT_NEAR(wide.camera.fov, 90, 1e-9);
}

TEST(SensorPlugin, PrincipalPointAndPlanes) {
    const Camera plain = scene_with_sensor("").camera;
    EXPECT_EQ(plain.kind, Camera::Kind::perspective);
    EXPECT_EQ(plain.near_clip, 0.01);
    EXPECT_EQ(plain.far_clip, 10000);
    const Camera camera = scene_with_sensor("<float name=\"principalPointOffsetX\" value=\"0.1\"/><float "
                                            "name=\"principal_point_offset_y\" value=\"-0.2\"/><float "
                                            "name=\"nearClip\" value=\"2\"/><float name=\"farClip\" value=\"5\"/>",
                                            "0.6.0")
                              .camera;
    EXPECT_EQ(camera.principal_x, 0.1);
    EXPECT_EQ(camera.principal_y, -0.2);
    EXPECT_EQ(camera.near_clip, 2);
    EXPECT_EQ(camera.far_clip, 5);
}

TEST(SensorPlugin, FarClipMayBeInfinite) {
    for (const char *text : {"inf", " Inf "}) {
        const Camera camera =
            scene_with_sensor(std::string("<float name=\"far_clip\" value=\"") + text + "\"/>").camera;
        EXPECT_EQ(camera.far_clip, 1e30);
        EXPECT_EQ(camera.near_clip, 0.01);
    }
}

LoadedScene scene_of_sensor(const std::string &sensor, const std::string &version) {
    return load_text("<scene version=\"" + version + "\">" + sensor +
                     "<shape type=\"cube\"/><emitter type=\"constant\"/></scene>");
}

TEST(SensorPlugin, ThinLens) {
    const LoadedScene old = scene_of_sensor("<sensor type=\"thinlens\"><float name=\"apertureRadius\" value=\"0.2\"/>"
                                            "<float name=\"focusDistance\" value=\"7\"/><float name=\"fov\" "
                                            "value=\"30\"/><float name=\"shutterOpen\" value=\"0\"/></sensor>",
                                            "0.6.0");
    EXPECT_THAT(old.warnings, IsEmpty());
    EXPECT_EQ(old.scene.camera.kind, Camera::Kind::thin_lens);
    EXPECT_EQ(old.scene.camera.aperture_radius, 0.2);
    EXPECT_EQ(old.scene.camera.focus_distance, 7);
    EXPECT_EQ(old.scene.camera.fov, 30);
    const LoadedScene far =
        scene_of_sensor("<sensor type=\"thinlens\"><float name=\"aperture_radius\" value=\"0.2\"/></sensor>", "3.0.0");
    EXPECT_EQ(far.scene.camera.focus_distance, 10000); // the far plane
    const LoadedScene pinhole =
        scene_of_sensor("<sensor type=\"thinlens\"><float name=\"aperture_radius\" value=\"0\"/></sensor>", "3.0.0");
    EXPECT_EQ(pinhole.scene.camera.kind, Camera::Kind::perspective);
    EXPECT_THAT(error_of_text("<scene version=\"3.0.0\"><sensor type=\"thinlens\"/><shape type=\"cube\"/></scene>"),
                HasSubstr("aperture_radius"));
}

TEST(SensorPlugin, Orthographic) {
    const LoadedScene loaded =
        scene_of_sensor("<sensor type=\"orthographic\"><transform name=\"toWorld\"><scale x=\"3\" "
                        "y=\"2\"/></transform></sensor>",
                        "0.5.0");
    EXPECT_THAT(loaded.warnings, IsEmpty());
    EXPECT_EQ(loaded.scene.camera.kind, Camera::Kind::orthographic);
    EXPECT_EQ(loaded.scene.camera.to_world.m[0], 3);
}

/// A camera may be as small as its model; its axes may not fall together.
TEST(SensorPlugin, PlacesThatCannotBeUndone) {
    const auto error = [](const std::string &steps) {
        return error_of_text("<scene version=\"3.0.0\"><sensor type=\"perspective\"><transform name=\"to_world\">" +
                             steps + "</transform></sensor><shape type=\"cube\"/></scene>");
    };
    EXPECT_EQ(error("<scale value=\"1e-11\"/>"), "");
    EXPECT_THAT(error("<scale y=\"0\"/>"), HasSubstr("has no inverse"));
    EXPECT_THAT(error("<matrix value=\"1e9 1e9 0 1e9 1e9 0 0 0 1\"/>"), HasSubstr("has no inverse"));
}

TEST(FilmPlugin, Defaults) {
    const FilmSettings film = scene_with_sensor("").film;
    EXPECT_EQ(film.width, 768u);
    EXPECT_EQ(film.height, 576u);
    EXPECT_EQ(film.crop_width, 0u);
    EXPECT_EQ(film.filter, FilmSettings::Filter::gaussian);
    EXPECT_FLOAT_EQ(film.filter_stddev, 0.5f);
    EXPECT_FLOAT_EQ(film.filter_radius, 2);
    EXPECT_EQ(scene_with_sensor("").settings.samples_per_pixel, 4u);
}

TEST(FilmPlugin, SizeAndCrop) {
    const FilmSettings film =
        scene_with_sensor("<film type=\"hdrfilm\"><integer name=\"width\" value=\"100\"/><integer name=\"height\" "
                          "value=\"50\"/><integer name=\"cropOffsetX\" value=\"10\"/><integer name=\"cropOffsetY\" "
                          "value=\"5\"/><integer name=\"cropWidth\" value=\"90\"/></film>",
                          "0.6.0")
            .film;
    EXPECT_EQ(film.width, 100u);
    EXPECT_EQ(film.crop_x, 10u);
    EXPECT_EQ(film.crop_y, 5u);
    EXPECT_EQ(film.crop_width, 90u);
    EXPECT_EQ(film.crop_height, 45u);
}

TEST(FilterPlugin, BoxTentGaussian) {
    const auto film_with = [](const std::string &filter) {
        return scene_with_sensor("<film type=\"hdrfilm\">" + filter + "</film>").film;
    };
    EXPECT_EQ(film_with("<rfilter type=\"box\"/>").filter, FilmSettings::Filter::box);
    const FilmSettings tent = film_with("<rfilter type=\"tent\"><float name=\"radius\" value=\"1.5\"/></rfilter>");
    EXPECT_EQ(tent.filter, FilmSettings::Filter::tent);
    EXPECT_FLOAT_EQ(tent.filter_radius, 1.5f);
    EXPECT_FLOAT_EQ(film_with("<rfilter type=\"tent\"/>").filter_radius, 1);
    const FilmSettings gaussian =
        film_with("<rfilter type=\"gaussian\"><float name=\"stddev\" value=\"0.4\"/></rfilter>");
    EXPECT_EQ(gaussian.filter, FilmSettings::Filter::gaussian);
    EXPECT_FLOAT_EQ(gaussian.filter_stddev, 0.4f);
    EXPECT_FLOAT_EQ(gaussian.filter_radius, 1.6f);
}

TEST(FilterPlugin, NegativeLobes) {
    const auto film_with = [](const std::string &filter, const std::string &version) {
        return scene_with_sensor("<film type=\"hdrfilm\">" + filter + "</film>", version).film;
    };
    const FilmSettings mitchell = film_with("<rfilter type=\"mitchell\"/>", "3.0.0");
    EXPECT_EQ(mitchell.filter, FilmSettings::Filter::mitchell);
    EXPECT_FLOAT_EQ(mitchell.filter_radius, 2);
    EXPECT_FLOAT_EQ(mitchell.mitchell_b, 1 / 3.0f);
    EXPECT_FLOAT_EQ(mitchell.mitchell_c, 1 / 3.0f);
    const FilmSettings sharper = film_with(
        "<rfilter type=\"mitchell\"><float name=\"B\" value=\"0.2\"/><float name=\"C\" value=\"0.4\"/></rfilter>",
        "0.6.0");
    EXPECT_FLOAT_EQ(sharper.mitchell_b, 0.2f);
    EXPECT_FLOAT_EQ(sharper.mitchell_c, 0.4f);
    EXPECT_EQ(film_with("<rfilter type=\"catmullrom\"/>", "0.5.0").filter, FilmSettings::Filter::catmullrom);
    const FilmSettings lanczos = film_with("<rfilter type=\"lanczos\"/>", "3.0.0");
    EXPECT_EQ(lanczos.filter, FilmSettings::Filter::lanczos);
    EXPECT_FLOAT_EQ(lanczos.filter_radius, 3);
    EXPECT_FLOAT_EQ(
        film_with("<rfilter type=\"lanczos\"><integer name=\"lobes\" value=\"2\"/></rfilter>", "0.6.0").filter_radius,
        2);
}

TEST(FilterPlugin, UnknownKindsWarnAndAreGaussian) {
    const LoadedScene loaded = load_text("<scene version=\"0.5.0\"><sensor type=\"perspective\"><film "
                                         "type=\"hdrfilm\">\n<rfilter type=\"wsinc\"><integer name=\"lobes\" "
                                         "value=\"4\"/></rfilter></film></sensor><emitter type=\"constant\"/></scene>");
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("scene.xml:2: the filter \"wsinc\" is not known")));
    EXPECT_EQ(loaded.scene.film.filter, FilmSettings::Filter::gaussian);
}

TEST(FilmPlugin, OtherKindsWarnAndKeepSizeCropAndFilter) {
    for (const char *type : {"specfilm", "mfilm", "tiledhdrfilm", "multichannel"}) {
        const LoadedScene loaded =
            load_text(std::string("<scene version=\"0.6.0\"><sensor type=\"perspective\">\n<film type=\"") + type +
                      "\"><integer name=\"width\" value=\"40\"/><integer name=\"cropWidth\" value=\"20\"/><string "
                      "name=\"variable\" value=\"x\"/><float name=\"gamma\" value=\"2.2\"/><rfilter type=\"box\"/>"
                      "</film></sensor><emitter type=\"constant\"/></scene>");
        EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr(std::string("scene.xml:2: the film \"") + type)));
        EXPECT_EQ(loaded.scene.film.width, 40u);
        EXPECT_EQ(loaded.scene.film.crop_width, 20u);
        EXPECT_EQ(loaded.scene.film.filter, FilmSettings::Filter::box);
    }
}

TEST(FilmPlugin, PixelFormatsThatMakeOtherImagesWarn) {
    const auto warnings = [](const std::string &format) {
        return load_text("<scene version=\"0.6.0\"><sensor type=\"perspective\"><film type=\"hdrfilm\">\n<string "
                         "name=\"pixelFormat\" value=\"" +
                         format + "\"/></film></sensor><emitter type=\"constant\"/></scene>")
            .warnings;
    };
    for (const char *format : {"luminance", "XYZ", "spectrum", "rgb, luminance"})
        EXPECT_THAT(warnings(format),
                    ElementsAre(AllOf(HasSubstr("scene.xml:2: pixel_format \""), HasSubstr("has no effect here"))))
            << format;
    for (const char *format : {"rgb", "RGBA", "rgb, rgba"})
        EXPECT_THAT(warnings(format), IsEmpty()) << format;
}

TEST(FilmPlugin, OneForDisplayIsReadInSilence) {
    const LoadedScene loaded =
        load_text("<scene version=\"0.6.0\"><sensor type=\"perspective\"><film type=\"ldrfilm\"><integer "
                  "name=\"width\" value=\"40\"/></film></sensor><emitter type=\"constant\"/></scene>");
    EXPECT_THAT(loaded.warnings, IsEmpty());
    EXPECT_EQ(loaded.scene.film.width, 40u);
}

TEST(SamplerPlugin, OfAnyKindItsCountIsTaken) {
    for (const char *type : {"independent", "stratified", "ldsampler", "multijitter", "orthogonal", "sobol", "halton",
                             "hammersley", "theirs"}) {
        const LoadedScene loaded =
            load_text(std::string("<scene version=\"0.6.0\"><sensor type=\"perspective\"><sampler type=\"") + type +
                      "\"><integer name=\"sampleCount\" value=\"12\"/><integer name=\"scramble\" value=\"-1\"/>"
                      "</sampler></sensor><emitter type=\"constant\"/></scene>");
        EXPECT_THAT(loaded.warnings, IsEmpty());
        EXPECT_EQ(loaded.scene.settings.samples_per_pixel, 12u);
    }
}

TEST(Media, AreLeftOutOnRequest) {
    const std::string body = "<medium type=\"heterogeneous\" id=\"m\"><volume name=\"density\" type=\"gridvolume\"/>"
                             "<phase type=\"hg\"/></medium><shape type=\"cube\"><ref name=\"interior\" id=\"m\"/>"
                             "</shape><shape type=\"sphere\"><ref name=\"exterior\" id=\"m\"/><bsdf "
                             "type=\"dielectric\"/></shape><shape type=\"cube\"><subsurface type=\"dipole\"/></shape>"
                             "<emitter type=\"constant\"/>";
    LoadOptions options;
    options.ignore_media = true;
    const LoadedScene old = load_text(scene_around(body, "0.6.0", ""), options);
    EXPECT_THAT(old.warnings, testing::Contains(HasSubstr("<medium type=\"heterogeneous\"> is left out")));
    EXPECT_THAT(old.warnings, testing::Contains(HasSubstr("<subsurface type=\"dipole\"> is left out")));
    // A boundary without a BSDF is not seen in 0.x; Mitsuba 3 makes it diffuse.
    ASSERT_EQ(old.scene.shapes.size(), 2u);
    EXPECT_EQ(old.scene.materials[old.scene.shapes[0].material].front.kind, BsdfKind::dielectric);
    EXPECT_EQ(old.scene.materials[old.scene.shapes[1].material].front.kind, BsdfKind::diffuse);
    const LoadedScene newer = load_text(scene_around(body, "3.0.0", ""), options);
    EXPECT_EQ(newer.scene.materials[newer.scene.shapes[0].material].front.kind, BsdfKind::diffuse);
    EXPECT_THAT(error_of_text(scene_around(body)), HasSubstr("--ignore-media"));
}

TEST(IntegratorPlugin, Path) {
    const RenderSettings settings =
        scene_with_sensor("", "0.6.0",
                          "<integrator type=\"path\"><integer name=\"maxDepth\" value=\"7\"/><integer name=\"rrDepth\" "
                          "value=\"9\"/><boolean name=\"hideEmitters\" value=\"True\"/></integrator>")
            .settings;
    EXPECT_EQ(settings.max_depth, 7);
    EXPECT_EQ(settings.rr_depth, 9);
    EXPECT_TRUE(settings.hide_emitters);
    EXPECT_EQ(settings.integrator, "path");
    const RenderSettings plain = scene_with_sensor("", "3.0.0", "<integrator type=\"path\"/>").settings;
    EXPECT_EQ(plain.max_depth, -1);
    EXPECT_EQ(plain.rr_depth, 5);
    EXPECT_FALSE(plain.hide_emitters);
}

TEST(IntegratorPlugin, Direct) {
    EXPECT_EQ(scene_with_sensor("", "3.0.0", "<integrator type=\"direct\"/>").settings.max_depth, 2);
}

TEST(IntegratorPlugin, UnknownKindsWarnAndKeepTheirDepths) {
    const LoadedScene loaded =
        load_text(scene_around("<integrator type=\"gpt\"><integer name=\"maxDepth\" value=\"4\"/><float "
                               "name=\"shiftThreshold\" value=\"0.1\"/></integrator><emitter type=\"constant\"/>"));
    EXPECT_THAT(loaded.warnings,
                ElementsAre(HasSubstr("scene.xml:3: the integrator \"gpt\" is a method here: --method gpt renders")));
    EXPECT_EQ(loaded.scene.settings.max_depth, 4);
    EXPECT_EQ(loaded.scene.settings.integrator, "gpt");
    const LoadedScene wrapped = load_text(scene_around(
        "<integrator type=\"aov\"><integrator type=\"path\"><integer name=\"max_depth\" value=\"3\"/></integrator>"
        "</integrator><emitter type=\"constant\"/>"));
    EXPECT_EQ(wrapped.scene.settings.max_depth, 3);
    EXPECT_THAT(wrapped.warnings, ElementsAre(HasSubstr("\"aov\" is passed over: the \"path\" that it wraps")));
}

/// Who asks for another image, or for a way to make it that there is, shall know; who asks for the same one need not.
TEST(IntegratorPlugin, UnknownKindsAreTalkedOfByWhatTheyMake) {
    const auto warnings = [](const std::string &type) {
        return load_text(scene_around("<integrator type=\"" + type + "\"/><emitter type=\"constant\"/>")).warnings;
    };
    EXPECT_THAT(warnings("volpath"), testing::IsEmpty());
    EXPECT_THAT(warnings("photonmapper"), ElementsAre(HasSubstr("--method sppm")));
    EXPECT_THAT(warnings("bdpt"), ElementsAre(HasSubstr("the same image in another way")));
    EXPECT_THAT(warnings("depth"), ElementsAre(HasSubstr("--aov")));
    EXPECT_THAT(warnings("theirs"), ElementsAre(HasSubstr("not known here")));
}

TEST(IntegratorPlugin, WhatIsWrappedIsReadAsItsOwnKind) {
    const auto settings = [](const std::string &integrator) {
        return load_text(scene_around(integrator + "<emitter type=\"constant\"/>")).scene.settings;
    };
    const std::string direct = "<integrator type=\"direct\"/>";
    EXPECT_EQ(settings("<integrator type=\"aov\">" + direct + "</integrator>").max_depth, 2);
    EXPECT_EQ(settings("<integrator type=\"moment\"><integrator type=\"aov\">" + direct + "</integrator></integrator>")
                  .max_depth,
              2);
    EXPECT_EQ(settings("<integrator type=\"aov\"><integrator type=\"theirs\"><integer name=\"max_depth\" "
                       "value=\"4\"/></integrator></integrator>")
                  .max_depth,
              4);
    EXPECT_EQ(
        settings("<integrator type=\"multichannel\"><integrator type=\"field\"/>" + direct + "</integrator>").max_depth,
        2)
        << "the one that makes paths, wherever it stands";
    EXPECT_EQ(settings("<integrator type=\"aov\" id=\"it\"><ref id=\"it\"/></integrator>").max_depth, -1);
}

} // namespace
} // namespace gradus
