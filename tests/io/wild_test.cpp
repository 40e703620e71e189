// What files of other people hold that few of them do.
#include "runtime/scene/transform.h"
#include "tests/io/scene_text.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace gradus {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Includes, OneObjectInAFileOfItsOwnIn0x) {
    TemporaryFolder folder;
    folder.write("red.xml", red_diffuse.substr(0, 5) + " id=\"red\"" + red_diffuse.substr(5));
    const LoadedScene loaded = load_scene(
        folder.write("scene.xml", scene_around("<include filename=\"red.xml\"/><shape type=\"cube\"><ref id=\"red\"/>"
                                               "</shape>",
                                               "0.5.0", constant_light)));
    EXPECT_THAT(loaded.warnings, IsEmpty());
    EXPECT_FLOAT_EQ(loaded.scene.materials.at(loaded.scene.shapes.at(0).material).front.reflectance.r, 0.5f);
}

TEST(Includes, OfNoVersionHaveThatOfTheFileThatIncludesThem) {
    TemporaryFolder folder;
    folder.write("part.xml",
                 "<scene><integrator type=\"path\"><integer name=\"maxDepth\" value=\"3\"/></integrator></scene>");
    const LoadedScene loaded = load_scene(
        folder.write("scene.xml", scene_around("<include filename=\"part.xml\"/>" + constant_light, "0.6.0")));
    EXPECT_THAT(loaded.warnings, IsEmpty());
    EXPECT_EQ(loaded.scene.settings.max_depth, 3);
}

std::string with_type(const std::string &declarations, const std::string &body) {
    return "<!DOCTYPE scene [" + declarations + "]>\n" + scene_around(body, "0.6.0", constant_light);
}

TEST(Entities, StandForText) {
    const LoadedScene loaded = load_text(with_type(
        "<!ENTITY r '0.5'> <!ENTITY ball \"<shape type='sphere'>\n<float name='radius' value='0.25'/></shape>\">",
        "<shape type=\"sphere\"><float name=\"radius\" value=\"&r;\"/></shape>&ball; "));
    ASSERT_EQ(loaded.scene.spheres.size(), 2u);
    EXPECT_FLOAT_EQ(loaded.scene.spheres[0].radius, 0.5f);
    EXPECT_FLOAT_EQ(loaded.scene.spheres[1].radius, 0.25f);
    EXPECT_THAT(error_of_text(with_type("<!ENTITY r \"\n0.5\n\">", "<shape type=\"sphere\"><float name=\"radius\" "
                                                                   "value=\"&r; m\"/></shape>")),
                HasSubstr("scene.xml:6: "))
        << "lines are those of the file";
}

TEST(Entities, StandForFiles) {
    TemporaryFolder folder;
    folder.write("header.xml", "<?xml version='1.0'?>\n<!-- depth --><integrator type=\"path\"><integer "
                               "name=\"maxDepth\" value=\"3\"/></integrator>\n" +
                                   std::string("<shape type=\"cube\"/>"));
    const LoadedScene loaded =
        load_scene(folder.write("scene.xml", with_type("<!ENTITY header SYSTEM \"header.xml\">", "&header;")));
    EXPECT_THAT(loaded.warnings, IsEmpty());
    EXPECT_EQ(loaded.scene.settings.max_depth, 3);
    EXPECT_EQ(loaded.scene.meshes.size(), 1u);
    // A scene may name any file.
    folder.write("secret.txt", "<?xml version='1.0'?>\nuser: 1000 <b/>");
    const std::string message = error_of(
        folder.write("spy.xml", with_type("<!ENTITY spy SYSTEM \"secret.txt\">", "&spy;<shape type=\"cube\"/>")));
    EXPECT_THAT(message, HasSubstr("not a part of a scene"));
    EXPECT_THAT(message, Not(HasSubstr("1000")));
    EXPECT_THAT(error_of_text(with_type("<!ENTITY header SYSTEM \"absent.xml\">", "&header;<shape type=\"cube\"/>")),
                HasSubstr("cannot find the included file \"absent.xml\""));
}

TEST(Entities, AreThoseThatTheTypeDeclares) {
    const auto radius = [](const std::string &before) {
        const LoadedScene loaded =
            load_text(before + scene_around("<shape type=\"sphere\"><float name=\"radius\" value=\"&r;\"/></shape>",
                                            "3.0.0", constant_light));
        EXPECT_THAT(loaded.warnings, IsEmpty());
        return loaded.scene.spheres.at(0).radius;
    };
    EXPECT_FLOAT_EQ(radius("<!DOCTYPE scene [<!-- <!ENTITY r \"0.1\"> ]> --><!ENTITY r \"0.5\">]>"), 0.5f);
    EXPECT_FLOAT_EQ(radius("<?xml version='1.0'?><!-- <!DOCTYPE scene [<!ENTITY r '0.1'>]> -->\n"
                           "<!DOCTYPE scene [<!ENTITY r \"0.5\">]>"),
                    0.5f);
    EXPECT_FLOAT_EQ(radius("<!DOCTYPE scene [<?a ' ]> ?><!ELEMENT b (c)><!ENTITY s ']>'>\n<!ENTITY r '0.5'>\n] \n>"),
                    0.5f);
    EXPECT_THAT(error_of_text("<!DOCTYPE scene SYSTEM 'a[<!ENTITY r \"2\">]>'>" +
                              scene_around("<shape type=\"sphere\"><float name=\"radius\" value=\"&r;\"/></shape>")),
                HasSubstr("not \"&r;\""));
}

TEST(Entities, StandInTheValuesOfOthers) {
    const LoadedScene loaded = load_text(
        with_type("<!ENTITY ball \"<shape type='sphere'>&size;</shape>\"> <!ENTITY size \"<float name='radius' "
                  "value='&r;'/>\"> <!ENTITY r '0.25'>",
                  "&ball;"));
    EXPECT_THAT(loaded.warnings, IsEmpty());
    EXPECT_FLOAT_EQ(loaded.scene.spheres.at(0).radius, 0.25f);
    EXPECT_THAT(load_text(with_type("<!ENTITY a '&b;'> <!ENTITY b '&a;'>", "&a;<shape type=\"cube\"/>")).warnings,
                ElementsAre(HasSubstr("stray text \"&a;")));
    // Two to the power of sixty references, of nothing at the end.
    std::string nested = "<!ENTITY e0 ''>";
    for (int i = 1; i <= 30; ++i)
        nested += fmt::format("<!ENTITY e{0} '&e{1};&e{1};&e{1};&e{1};'>", i, i - 1);
    EXPECT_THAT(load_text(with_type(nested, "&e30;<shape type=\"cube\"/>")).warnings,
                ElementsAre(HasSubstr("stray text \"&e30;")));
}

/// Of ten thousand entities, each of a million characters, none is put in its place.
TEST(Entities, DoNotFillTheMemory) {
    std::string many;
    for (int i = 0; i < 10000; ++i)
        many += "&e;";
    const std::string text =
        with_type("<!ENTITY e \"" + std::string(1000000, ' ') + "\">", many + "<shape type=\"cube\"/>");
    EXPECT_THAT(load_text(text).warnings, ElementsAre(HasSubstr("stray text \"&e;")));
}

TEST(SpectrumFiles, AreReadAsIfTheyStoodThere) {
    TemporaryFolder folder;
    folder.write("spectra/red.spd", "\xEF\xBB\xBF# nm\n400 0.1\r\n\n500\t0.2 # green\n600, 0.7\r700 0.8\n");
    const auto reflectance = [&](const std::string &attribute) {
        const LoadedScene loaded = load_scene(folder.write(
            "scene.xml", scene_around("<path value=\"spectra\"/><shape type=\"cube\"><bsdf type=\"diffuse\"><spectrum "
                                      "name=\"reflectance\" " +
                                          attribute + "/></bsdf></shape>",
                                      "0.6.0", "")));
        return loaded.scene.materials.at(loaded.scene.shapes.at(0).material).front.reflectance;
    };
    const Rgb of_file = reflectance("filename=\"red.spd\"");
    const Rgb written = reflectance("value=\"400:0.1, 500:0.2, 600:0.7, 700:0.8\"");
    EXPECT_EQ(of_file.r, written.r);
    EXPECT_EQ(of_file.g, written.g);
    EXPECT_EQ(of_file.b, written.b);
    EXPECT_GT(of_file.r, of_file.b);
}

TEST(SpectrumFiles, ThatAreNoneAreErrors) {
    TemporaryFolder folder;
    folder.write("secret.txt", "user 1000\n");
    for (const auto &[name, message] : {std::pair{"secret.txt", "is no file of a spectrum"},
                                        std::pair{"absent.spd", "cannot find the file of a spectrum \"absent.spd\""}}) {
        const std::string text =
            error_of(folder.write("scene.xml", scene_around("<shape type=\"cube\"><bsdf type=\"diffuse\"><spectrum "
                                                            "name=\"reflectance\" filename=\"" +
                                                            std::string(name) + "\"/></bsdf></shape>")));
        EXPECT_THAT(text, HasSubstr(message));
        EXPECT_THAT(text, Not(HasSubstr("1000")));
    }
}

TEST(Textures0x, HaveOneScaleForBothCoordinates) {
    const LoadedScene loaded = load_text(scene_around(
        "<shape type=\"cube\"><bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"checkerboard\"><float "
        "name=\"uvscale\" value=\"5\"/><float name=\"vscale\" value=\"2\"/></texture></bsdf></shape>",
        "0.6.0", constant_light));
    EXPECT_THAT(loaded.warnings, IsEmpty());
    EXPECT_FLOAT_EQ(loaded.scene.textures.at(0).to_uv[0], 5);
    EXPECT_FLOAT_EQ(loaded.scene.textures.at(0).to_uv[4], 2);
}

TEST(BumpMaps, AreCalledBumpIn0x4) {
    const std::string body = "<shape type=\"cube\"><bsdf type=\"bump\"><texture type=\"scale\"><texture "
                             "type=\"checkerboard\"/></texture>" +
                             red_diffuse + "</bsdf></shape>";
    EXPECT_EQ(error_of_text(scene_around(body, "0.4.0", "")), "");
    EXPECT_THAT(error_of_text(scene_around(body, "3.0.0", "")), HasSubstr("\"bump\""));
}

TEST(Transform, ARotationByNothingNeedsNoAxis) {
    EXPECT_EQ(error_of_text(scene_around("<shape type=\"cube\"><transform name=\"to_world\"><rotate x=\"0\" y=\"0\" "
                                         "z=\"0\" angle=\"0\"/></transform></shape>")),
              "");
}

TEST(Animation, StandsStillAtItsStart) {
    const auto place_of = [](const std::string &times) {
        std::string frames;
        for (const char time : times)
            frames += fmt::format("<transform time=\"{0}\"><translate x=\"{0}\"/></transform>", time - '3');
        const LoadedScene loaded = load_text(
            scene_around("<shape type=\"sphere\"><animation name=\"toWorld\">" + frames + "</animation></shape>",
                         "0.6.0", constant_light));
        EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("motion is not supported")));
        return loaded.scene.spheres.at(0).center.x;
    };
    EXPECT_EQ(place_of("1345"), 0); // times from -2 to 2
    EXPECT_EQ(place_of("5124"), -1);
    EXPECT_EQ(place_of("654"), 1);
    EXPECT_THAT(error_of_text(scene_around("<shape type=\"cube\"><animation name=\"to_world\"><transform/></animation>"
                                           "</shape>")),
                HasSubstr("with a time each"));
}

/// The corners of what is there lie within the view, and the nearest ones at its edge.
TEST(SceneWithoutSensor, IsSeenWhole) {
    const LoadedScene loaded = load_text("<scene version=\"0.6.0\"><shape type=\"cube\"><transform name=\"toWorld\">"
                                         "<scale x=\"2\" y=\"3\" z=\"1\"/><translate x=\"5\" z=\"7\"/></transform>"
                                         "<emitter type=\"area\"/></shape></scene>");
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("has no <sensor>; all of it is seen along z")));
    const Camera &camera = loaded.scene.camera;
    const Double3 from = {camera.to_world.m[3], camera.to_world.m[7], camera.to_world.m[11]};
    EXPECT_EQ(from[0], 5);
    EXPECT_EQ(from[1], 0);
    EXPECT_NEAR(3 / (6 - from[2]), std::tan(0.5 * camera.fov * std::numbers::pi / 180), 1e-12);
    EXPECT_LT(camera.near_clip, 6 - from[2]);
    EXPECT_GT(camera.far_clip, 8 - from[2]);
}

} // namespace
} // namespace gradus
