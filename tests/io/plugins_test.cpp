// BSDFs, emitters, sensor, film, filters and integrators in both dialects, value by value.
#include "tests/io/scene_text.h"

#include <cmath>

namespace gradus {
namespace {

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

Scene scene_of(const std::string &bsdf) {
    return load_text(scene_around("<shape type=\"cube\">" + bsdf + "</shape><emitter type=\"constant\"/>", "3.0.0", ""))
        .scene;
}

TEST(BsdfPlugin, Blend) {
    const std::string red = "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"1 0 0\"/></bsdf>";
    const std::string mirror = "<bsdf type=\"conductor\"/>", glass = "<bsdf type=\"dielectric\"/>";
    const auto blend = [](const std::string &inside) { return "<bsdf type=\"blendbsdf\">" + inside + "</bsdf>"; };
    const Scene plain = scene_of(blend(red + mirror));
    ASSERT_EQ(plain.blends.size(), 1u);
    EXPECT_EQ(plain.materials.at(0).front.blend, 0);
    EXPECT_FALSE(plain.materials.at(0).two_sided);
    EXPECT_EQ(plain.blends[0].weight, 0.5f);
    EXPECT_EQ(plain.blended.at(plain.blends[0].first).reflectance.r, 1);
    EXPECT_EQ(plain.blended.at(plain.blends[0].second).kind, BsdfKind::conductor);
    const Scene weighted = scene_of(blend("<float name=\"weight\" value=\"0.25\"/>" + mirror + glass));
    EXPECT_EQ(weighted.blends.at(0).weight, 0.25f);
    const Scene textured = scene_of(blend("<texture name=\"weight\" type=\"checkerboard\"/>" + red + mirror));
    EXPECT_EQ(textured.blends.at(0).weight.texture, 0);
    // Both sides: of the blend, of a part, of both parts.
    const Scene around = scene_of("<bsdf type=\"twosided\">" + blend(red + mirror) + "</bsdf>");
    EXPECT_TRUE(around.materials.at(0).two_sided);
    EXPECT_EQ(around.materials.at(0).back.blend, around.materials.at(0).front.blend);
    const Scene of_one = scene_of(blend("<bsdf type=\"twosided\">" + red + "</bsdf>" + mirror));
    EXPECT_TRUE(of_one.materials.at(0).two_sided);
    const Blend &back = of_one.blends.at(std::size_t(of_one.materials.at(0).back.blend));
    EXPECT_EQ(of_one.blended.at(back.first).reflectance.r, 1);
    EXPECT_EQ(of_one.blended.at(back.second).reflectance, Color(0, 0, 0));
    const Scene nested = scene_of(blend(blend(red + mirror) + glass));
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

TEST(EmitterPlugin, Constant) {
    const Emitter emitter =
        emitter_of("<emitter type=\"constant\"><spectrum name=\"radiance\" value=\"5000\"/></emitter>", "0.6.0");
    EXPECT_EQ(emitter.kind, Emitter::Kind::constant);
    expect_rgb(emitter.value, 5000, 5000, 5000);
    expect_rgb(emitter_of("<emitter type=\"constant\"/>").value, 1, 1, 1);
}

TEST(EmitterPlugin, Point) {
    const Emitter emitter = emitter_of("<emitter type=\"point\"><point name=\"position\" x=\"1\" y=\"2\" z=\"3\"/><rgb "
                                       "name=\"intensity\" value=\"4 5 6\"/></emitter>");
    EXPECT_EQ(emitter.kind, Emitter::Kind::point);
    expect_vector(emitter.position, 1, 2, 3);
    expect_rgb(emitter.value, 4, 5, 6);
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

TEST(SensorPlugin, PrincipalPointWarns) {
    const LoadedScene loaded = load_text("<scene version=\"3.0.0\"><sensor type=\"perspective\">\n<float "
                                         "name=\"principal_point_offset_x\" value=\"0.1\"/></sensor><emitter "
                                         "type=\"constant\"/></scene>");
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("scene.xml:2: \"principal_point_offset_x\" is not supported")));
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
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("scene.xml:3: the integrator \"gpt\" is not known")));
    EXPECT_EQ(loaded.scene.settings.max_depth, 4);
    EXPECT_EQ(loaded.scene.settings.integrator, "gpt");
    const LoadedScene wrapped = load_text(scene_around(
        "<integrator type=\"aov\"><integrator type=\"path\"><integer name=\"max_depth\" value=\"3\"/></integrator>"
        "</integrator><emitter type=\"constant\"/>"));
    EXPECT_EQ(wrapped.scene.settings.max_depth, 3);
}

} // namespace
} // namespace gradus
