// What happens to a scene file as text: parameters, includes, references, unknown parameters, file search.
#include "runtime/io/image_io.h"
#include "runtime/io/properties.h"
#include "tests/io/scene_text.h"

#include <fmt/format.h>

namespace gradus {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

const char *const sensor_with_spp = "<sensor type=\"perspective\"><sampler type=\"independent\"><integer "
                                    "name=\"sample_count\" value=\"$spp\"/></sampler></sensor>";

TEST(Parameters, DefaultAndOverride) {
    const std::string text = std::string("<scene version=\"3.0.0\"><default name=\"spp\" value=\"16\"/>") +
                             sensor_with_spp + "<shape type=\"sphere\"/></scene>";
    EXPECT_EQ(load_text(text).scene.settings.samples_per_pixel, 16u);
    EXPECT_EQ(load_text(text, {{{"spp", "99"}}, false}).scene.settings.samples_per_pixel, 99u);
}

TEST(Document, TellsAllParametersWithoutAValueAtOnce) {
    const std::string error =
        error_of_text(scene_around("<shape type=\"sphere\"><float name=\"radius\" value=\"$r\"/>"
                                   "<point name=\"center\" x=\"$x\" y=\"$x\" z=\"$z\"/></shape>"));
    for (const char *name : {"$r", "$x", "$z"})
        EXPECT_THAT(error, HasSubstr(std::string("parameter ") + name + " has no value"));
    EXPECT_EQ(error.find("$x has"), error.rfind("$x has")) << "once is enough";
}

TEST(Document, TellsAllParametersOfOneValueAtOnce) {
    const std::string error =
        error_of_text(scene_around("<shape type=\"sphere\"><point name=\"center\" value=\"$x, $y, $deep\"/></shape>"
                                   "<default name=\"deep\" value=\"$a$b\"/>"));
    for (const char *name : {"$x", "$y", "$a", "$b"})
        EXPECT_THAT(error, HasSubstr(std::string("parameter ") + name + " has no value"));
    EXPECT_THAT(error_of_text(scene_around("<shape type=\"$x$c\"/><default name=\"c\" value=\"$d\"/>"
                                           "<default name=\"d\" value=\"$c\"/>")),
                HasSubstr("in a circle"));
}

TEST(Document, TakesDefaultsWhereverTheyStand) {
    const Scene scene = load_text(scene_around("<shape type=\"sphere\"><bsdf type=\"diffuse\"><default name=\"r\" "
                                               "value=\"0.25\"/></bsdf><float name=\"radius\" value=\"$r\"/></shape>"
                                               "<emitter type=\"constant\"/>"))
                            .scene;
    EXPECT_EQ(scene.spheres.at(0).radius, 0.25f);
}

TEST(Document, SaysWhereNoMitsubaHasThatVersion) {
    for (const char *version : {"1.0.0", "4.0"}) {
        // Copper by default in 0.x, a mirror in 3.
        const LoadedScene loaded = load_text(scene_around("<emitter type=\"constant\"/><shape type=\"sphere\"><bsdf "
                                                          "type=\"conductor\"/></shape>",
                                                          version));
        EXPECT_THAT(loaded.warnings, ::testing::ElementsAre(HasSubstr("read as version 3")));
        EXPECT_EQ(loaded.scene.materials[0].front.specular_reflectance.r, 1);
    }
    for (const char *version : {"0.4.0", "0.6.0", "2.1.0", "3.9.0"})
        EXPECT_THAT(load_text(scene_around("<emitter type=\"constant\"/><shape type=\"sphere\"/>", version)).warnings,
                    ::testing::IsEmpty());
}

TEST(Document, SaysWhereAFilmOrASamplerIsNoSensors) {
    const LoadedScene loaded =
        load_text(scene_around("<emitter type=\"constant\"/><shape type=\"sphere\"/><film type=\"hdrfilm\"/><sampler "
                               "type=\"independent\" id=\"s\"/><rfilter type=\"box\"/>"));
    EXPECT_THAT(loaded.warnings,
                ::testing::ElementsAre(HasSubstr("<film> is passed over"), HasSubstr("<sampler> is passed over"),
                                       HasSubstr("belongs into the sensor's <film>")));
    const std::string shared = "<scene version=\"3.0.0\"><rfilter type=\"box\" id=\"r\"/><film type=\"hdrfilm\" "
                               "id=\"f\"><ref id=\"r\"/></film><sampler type=\"independent\" id=\"s\"/><sensor "
                               "type=\"perspective\"><ref id=\"f\"/><ref id=\"s\"/></sensor><emitter "
                               "type=\"constant\"/><shape type=\"sphere\"/></scene>";
    EXPECT_THAT(load_text(shared).warnings, ::testing::IsEmpty());
}

TEST(Parameters, StandInTypesBooleansAndParts) {
    const std::string text = "<scene version=\"3.0.0\"><default name=\"kind\" value=\"sphere\"/>"
                             "<default name=\"flip\" value=\"True\"/><default name=\"r\" value=\"2\"/>"
                             "<default name=\"double\" value=\"$r$r\"/>"
                             "<sensor type=\"perspective\"/><shape type=\"$kind\"><boolean name=\"flip_normals\" "
                             "value=\"$flip\"/><float name=\"radius\" value=\"$double.5\"/></shape></scene>";
    const Scene scene = load_text(text).scene;
    ASSERT_EQ(scene.spheres.size(), 1u);
    EXPECT_FLOAT_EQ(scene.spheres[0].radius, 22.5f);
    EXPECT_TRUE(scene.spheres[0].flip_normals);
}

TEST(Parameters, LongestKnownNameCounts) {
    const std::string text = "<scene version=\"3.0.0\"><default name=\"r\" value=\"3\"/><default name=\"ra\" "
                             "value=\"4\"/><sensor type=\"perspective\"/><shape type=\"sphere\"><float "
                             "name=\"radius\" value=\"$ra\"/></shape></scene>";
    EXPECT_FLOAT_EQ(load_text(text).scene.spheres[0].radius, 4);
}

TEST(Parameters, GivenOnTheCommandLineAlone) {
    const std::string text =
        std::string("<scene version=\"3.0.0\">") + sensor_with_spp + "<shape type=\"sphere\"/></scene>";
    EXPECT_EQ(load_text(text, {{{"spp", "7"}}, false}).scene.settings.samples_per_pixel, 7u);
}

TEST(Parameters, UnknownOnTheCommandLineIsAnErrorWithTheKnownOnes) {
    const std::string text = scene_around("<default name=\"resolution\" value=\"16\"/>");
    const std::string message = error_of_text(text, {{{"resolutoin", "8"}}, false});
    EXPECT_THAT(message, HasSubstr("-D resolutoin"));
    EXPECT_THAT(message, HasSubstr("did you mean resolution"));
}

TEST(Parameters, UsedBeforeTheIncludedDefault) {
    TemporaryFolder folder;
    folder.write("defaults.xml", "<scene version=\"3.0.0\"><default name=\"spp\" value=\"5\"/>"
                                 "<default name=\"shape_file\" value=\"shape\"/></scene>");
    folder.write("shape.xml", "<shape version=\"3.0.0\" type=\"cube\"/>");
    const std::string path = folder.write("scene.xml", std::string("<scene version=\"3.0.0\">") + sensor_with_spp +
                                                           "<include filename=\"$shape_file.xml\"/>"
                                                           "<include filename=\"defaults.xml\"/></scene>");
    const Scene scene = load_scene(path).scene;
    EXPECT_EQ(scene.settings.samples_per_pixel, 5u);
    EXPECT_EQ(scene.shapes.size(), 1u);
}

TEST(Parameters, FirstDefaultCounts) {
    const std::string text = std::string("<scene version=\"3.0.0\"><default name=\"spp\" value=\"1\"/>"
                                         "<default name=\"spp\" value=\"2\"/>") +
                             sensor_with_spp + "<shape type=\"sphere\"/></scene>";
    EXPECT_EQ(load_text(text).scene.settings.samples_per_pixel, 1u);
}

TEST(Includes, SensorAndFilmInTheirOwnFileOfAnotherDialect) {
    TemporaryFolder folder;
    folder.write("sub/camera.xml", "<scene version=\"0.5.0\"><sensor type=\"perspective\"><float name=\"fov\" "
                                   "value=\"33\"/><string name=\"fovAxis\" value=\"smaller\"/></sensor></scene>");
    const std::string path = folder.write(
        "scene.xml",
        "<?xml version='1.0' encoding='utf-8'?>\n<scene version=\"3.0.0\"><include filename=\"sub/camera.xml\"/>"
        "<shape type=\"sphere\"/></scene>");
    const LoadedScene loaded = load_scene(path);
    EXPECT_DOUBLE_EQ(loaded.scene.camera.fov, 33);
    EXPECT_EQ(loaded.scene.camera.fov_axis, Camera::FovAxis::smaller);
    EXPECT_EQ(loaded.scene.path, path);
}

TEST(Includes, PathAddsAFolder) {
    TemporaryFolder folder;
    folder.write("elsewhere/mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const std::string path =
        folder.write("scene.xml", scene_around("<path value=\"elsewhere\"/><shape type=\"obj\"><string "
                                               "name=\"filename\" value=\"mesh.obj\"/></shape>",
                                               "3.0.0", ""));
    EXPECT_EQ(load_scene(path).scene.meshes.size(), 1u);
}

// As Mitsuba's resolver has it.
TEST(Includes, FoldersThatAreNamedGoBeforeTheScenesAndTheLastFirst) {
    TemporaryFolder folder;
    const std::string one = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\n", two = one + "f 2 3 4\n",
                      three = two + "f 1 2 4\n";
    folder.write("mesh.obj", one);
    folder.write("first/mesh.obj", two);
    folder.write("second/mesh.obj", three);
    const auto triangles_with = [&](const std::string &paths) {
        const std::string path = folder.write(
            "scene.xml",
            scene_around(paths + "<shape type=\"obj\"><string name=\"filename\" value=\"mesh.obj\"/></shape>", "3.0.0",
                         ""));
        return load_scene(path).scene.meshes.at(0).triangles.size();
    };
    EXPECT_EQ(triangles_with(""), 1u);
    EXPECT_EQ(triangles_with("<path value=\"first\"/>"), 2u);
    EXPECT_EQ(triangles_with("<path value=\"first\"/><path value=\"second\"/>"), 3u);
}

/// As in the programs that such files were written for: an included file's own folder goes first for what it includes.
TEST(Includes, OfAnIncludedFileLieBesideIt) {
    TemporaryFolder folder;
    const auto ball = [&](const std::string &file, const char *radius) {
        folder.write(file, std::string("<scene version='3.0.0'><shape type='sphere'><float name='radius' value='") +
                               radius + "'/></shape></scene>");
    };
    ball("lib/b.xml", "7");
    ball("sub/b.xml", "3");
    folder.write("sub/a.xml", "<scene version='3.0.0'><include filename='b.xml'/></scene>");
    const auto radius_with = [&](const std::string &includes) {
        const std::string text = scene_around(constant_light + "<path value=' lib\\. '/>" + includes, "3.0.0", "");
        return load_scene(folder.write("scene.xml", text)).scene.spheres.at(0).radius;
    };
    EXPECT_EQ(radius_with("<include filename='sub/a.xml'/>"), 3);
    EXPECT_EQ(radius_with("<include filename='b.xml'/>"), 7);
}

TEST(Includes, MeshesMayLieBesideTheIncludedFile) {
    TemporaryFolder folder;
    folder.write("part/mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write("part/part.xml", "<shape version=\"3.0.0\" type=\"obj\"><string name=\"filename\" "
                                  "value=\"mesh.obj\"/></shape>");
    const std::string path =
        folder.write("scene.xml", scene_around("<include filename=\"part/part.xml\"/>", "3.0.0", ""));
    EXPECT_EQ(load_scene(path).scene.meshes.size(), 1u);
}

/// What would be lost without a word: a part of a value, a word that is misspelt, a group that is nowhere.
TEST(Unused, PartsOfPropertiesAndUnknownAttributesAreWarnedOf) {
    const LoadedScene loaded =
        load_text(scene_around("<bsdf type='diffuse' id='m'/><shape type='sphere'>"
                               "<ref id='m'><rgb name='reflectance' value='1 0 0'/></ref>\n"
                               "<emitter type='area'><rgb name='radiance' value='2'><float name='scale' value='3'/>"
                               "</rgb></emitter>\n"
                               "<point name='center' X='3'/>\n"
                               "<transform name='to_world'><scale X='3'/><translate value='1' x='5'/></transform>"
                               "</shape>\n<shape type='shapegroup' id='g'><shape type='cube'/></shape>"));
    EXPECT_THAT(loaded.warnings,
                UnorderedElementsAre(
                    AllOf(HasSubstr("scene.xml:3: "), HasSubstr("<rgb> in <ref> is not used")),
                    AllOf(HasSubstr("scene.xml:4: "), HasSubstr("<float> in <rgb> is not used")),
                    AllOf(HasSubstr("scene.xml:5: "), HasSubstr("unknown attribute \"X\" of <point name=\"center\">")),
                    AllOf(HasSubstr("scene.xml:6: "), HasSubstr("unknown attribute \"X\" of <scale>")),
                    AllOf(HasSubstr("scene.xml:6: "), HasSubstr("<translate>: value stands for x, too")),
                    AllOf(HasSubstr("scene.xml:7: "), HasSubstr("no instance names this shapegroup"))));
}

/// Where nobody reads them they are told of, whatever element has them; ids and names may be everywhere.
TEST(Unused, AttributesOfEveryElementAreWarnedOf) {
    const auto unknown = [](const char *line, const char *element) {
        return AllOf(HasSubstr(line), HasSubstr(std::string("unknown attribute \"X\" of ") + element));
    };
    const LoadedScene loaded = load_text(
        "<scene version='3.0.0' xmlns='urn:a' X='1' type='scene'>\n"
        "<default name='radius' value='2' X='1'/>\n"
        "<path value='no-such-folder' X='1'/>\n"
        "<bsdf type='diffuse' id='m' name='m' X='1'><rgb name='reflectance' value='1 0 0' intent='reflectance'/>\n"
        "<spectrum name='unheard' id='s' value='1' X='1'/></bsdf>\n"
        "<shape type='sphere'><float name='radius' id='r' value='$radius' X='1'/><ref id='m' name='bsdf' X='1'/>\n"
        "<point name='center' value='0' z='3'/>\n"
        "<transform name='to_world' id='t' X='1'><lookAt origin='0 0 1' target='0 0 0' up='0 1 0' X='1'/>\n"
        "<matrix value='1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1' angle='3'/><rotate z='1' angle='0'/></transform></shape>\n"
        "<alias id='m' as='n' X='1'/><emitter type='constant'/>\n"
        "<sensor type='perspective'/></scene>");
    EXPECT_THAT(loaded.warnings,
                UnorderedElementsAre(
                    unknown("xml:1: ", "<scene type=\"scene\">"), HasSubstr("xml:1: unknown attribute \"type\""),
                    unknown("xml:2: ", "<default name=\"radius\">"), unknown("xml:3: ", "<path>"),
                    AllOf(HasSubstr("xml:3: <path>: there is no folder"), HasSubstr("no-such-folder")),
                    unknown("xml:4: ", "<bsdf type=\"diffuse\" name=\"m\">"),
                    unknown("xml:5: ", "<spectrum name=\"unheard\">"),
                    HasSubstr("xml:5: unknown parameter \"unheard\""), unknown("xml:6: ", "<float name=\"radius\">"),
                    unknown("xml:6: ", "<ref name=\"bsdf\">"),
                    HasSubstr("xml:7: <point name=\"center\">: value stands for z, too"),
                    unknown("xml:8: ", "<transform name=\"to_world\">"), unknown("xml:8: ", "<lookAt>"),
                    HasSubstr("xml:9: unknown attribute \"angle\" of <matrix>"), unknown("xml:10: ", "<alias>")));
}

/// Of an object's parameters, of objects in it and, through another file, of more; in the dialect of each.
TEST(Includes, WithinObjects) {
    TemporaryFolder folder;
    folder.write("parts/material.xml",
                 "<bsdf version=\"3.0.0\" type=\"diffuse\"><rgb name=\"reflectance\" value=\"$gray\"/>"
                 "</bsdf>");
    folder.write("parts/all.xml",
                 "<scene version=\"0.6.0\"><default name=\"gray\" value=\"0.25\"/><float name=\"radius\" "
                 "value=\"3\"/><boolean name=\"flipNormals\" value=\"true\"/><include "
                 "filename=\"$name.xml\"/></scene>");
    const LoadedScene loaded =
        load_scene(folder.write("scene.xml", scene_around("<shape type=\"sphere\"><include filename=\"parts/all.xml\"/>"
                                                          "</shape><default name=\"name\" value=\"material\"/>" +
                                                              constant_light,
                                                          "3.0.0", "")));
    EXPECT_THAT(loaded.warnings, IsEmpty());
    EXPECT_EQ(loaded.scene.spheres.at(0).radius, 3);
    EXPECT_TRUE(loaded.scene.spheres.at(0).flip_normals);
    expect_rgb(loaded.scene.materials.at(0).front.reflectance, 0.25, 0.25, 0.25);
    EXPECT_THAT(error_of(folder.write("scene.xml", scene_around("<shape type=\"sphere\">\n<include "
                                                                "filename=\"parts/none.xml\"/></shape>"))),
                HasSubstr("scene.xml:4: cannot find the included file"));
    EXPECT_THAT(error_of(folder.write("scene.xml", scene_around("<shape type=\"sphere\">\n<include "
                                                                "filename=\"scene.xml\"/></shape>"))),
                HasSubstr("a circle?"));
}

/// What is missing beside one file may lie beside another.
TEST(FileSearch, OneNameInTwoFolders) {
    TemporaryFolder folder;
    Image white;
    white.width = white.height = 1;
    white.channels = {{"R", {1}}, {"G", {1}}, {"B", {1}}};
    std::filesystem::create_directories(folder.path() / "b");
    write_png(white, (folder.path() / "b/picture.png").string());
    const std::string includes =
        "<include filename=\"a/part.xml\"/><include filename=\"b/part.xml\"/>" + constant_light;
    for (const char *name : {"a", "b"})
        folder.write(name + std::string("/part.xml"),
                     "<scene version=\"3.0.0\"><bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"bitmap\">"
                     "<string name=\"filename\" value=\"picture.png\"/></texture></bsdf></scene>");
    EXPECT_THAT(load_scene(folder.write("scene.xml", scene_around(includes))).warnings,
                ElementsAre(AllOf(HasSubstr("a/part.xml"), HasSubstr("cannot find"))));
    for (const char *name : {"a", "b"})
        folder.write(name + std::string("/part.xml"), "<shape version=\"3.0.0\" type=\"obj\"><string name=\"filename\" "
                                                      "value=\"no.obj\"/></shape>");
    EXPECT_THAT(error_of(folder.write("scene.xml", scene_around(includes))),
                AllOf(HasSubstr("a/part.xml"), HasSubstr("b/part.xml")));
}

TEST(FileSearch, WrongCaseAndBackslashesAreForgiven) {
    TemporaryFolder folder;
    folder.write("Meshes/The Räum.OBJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const auto scene_with = [&](const std::string &name) {
        return folder.write("scene.xml", scene_around("<shape type=\"obj\"><string name=\"filename\" value=\"" + name +
                                                          "\"/></shape>\n<emitter type=\"constant\"/>",
                                                      "3.0.0", ""));
    };
    EXPECT_THAT(load_scene(scene_with("Meshes\\The Räum.OBJ")).warnings, IsEmpty());
    const LoadedScene loaded = load_scene(scene_with("meshes\\the Räum.obj"));
    EXPECT_EQ(loaded.scene.meshes.size(), 1u);
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("scene.xml:3: \"meshes\\the Räum.obj\" differs in case")));
}

TEST(References, WithOrWithoutNameNestedAndAliased) {
    const std::string text =
        scene_around("<bsdf type=\"twosided\" id=\"outer\"><bsdf type=\"diffuse\" id=\"inner\">"
                     "<rgb name=\"reflectance\" value=\"0.25\"/></bsdf></bsdf>\n<alias id=\"inner\" as=\"other\"/>\n"
                     "<shape type=\"cube\"><ref id=\"outer\"/></shape>"
                     "<shape type=\"cube\"><ref name=\"bsdf\" id=\"inner\"/></shape>"
                     "<shape type=\"cube\"><ref id=\"other\"/></shape>\n<emitter type=\"constant\"/>",
                     "3.0.0", "");
    const LoadedScene loaded = load_text(text);
    EXPECT_THAT(loaded.warnings, IsEmpty());
    ASSERT_EQ(loaded.scene.shapes.size(), 3u);
    ASSERT_EQ(loaded.scene.materials.size(), 2u);
    EXPECT_TRUE(loaded.scene.materials[loaded.scene.shapes[0].material].two_sided);
    EXPECT_FALSE(loaded.scene.materials[loaded.scene.shapes[1].material].two_sided);
    EXPECT_EQ(loaded.scene.shapes[1].material, loaded.scene.shapes[2].material);
    EXPECT_EQ(loaded.scene.materials[0].name, "outer");
}

TEST(References, NamesThatStandForNamesEndSomewhere) {
    const auto scene_with = [](int aliases) {
        std::string text = "<bsdf type=\"diffuse\" id=\"a0\"/>";
        for (int i = 0; i < aliases; ++i)
            text += fmt::format("<alias id=\"a{}\" as=\"a{}\"/>", i, i + 1);
        text += fmt::format("<shape type=\"cube\"><ref id=\"a{}\"/></shape>\n<emitter type=\"constant\"/>", aliases);
        return scene_around(text, "3.0.0", "");
    };
    EXPECT_EQ(load_text(scene_with(16)).scene.shapes.size(), 1u);
    const std::string too_many = error_of_text(scene_with(17));
    EXPECT_THAT(too_many, HasSubstr("nothing has the id \"a17\" after 16 names that stand for names"));
    EXPECT_THAT(too_many, testing::Not(HasSubstr("did you mean")));
    EXPECT_THAT(error_of_text(scene_around("<alias id=\"b\" as=\"a\"/><alias id=\"a\" as=\"b\"/>"
                                           "<shape type=\"cube\"><ref id=\"a\"/></shape>")),
                HasSubstr("nothing has the id \"a\" after 16 names that stand for names; do they go in a circle?"));
    EXPECT_THAT(error_of_text(scene_around("<alias id=\"b\" as=\"a\"/><shape type=\"cube\"><ref id=\"a\"/></shape>")),
                HasSubstr("nothing has the id \"a\""));
}

TEST(References, FilmAndSamplerOfTheScene) {
    const std::string text = "<scene version=\"0.6.0\"><film type=\"hdrfilm\" id=\"f\"><integer name=\"width\" "
                             "value=\"20\"/><integer name=\"height\" value=\"10\"/></film><sampler "
                             "type=\"ldsampler\" id=\"s\"><integer name=\"sampleCount\" value=\"12\"/></sampler>"
                             "<sensor type=\"perspective\"><ref id=\"f\"/><ref id=\"s\"/></sensor>"
                             "<shape type=\"cube\"/></scene>";
    const Scene scene = load_text(text).scene;
    EXPECT_EQ(scene.film.width, 20u);
    EXPECT_EQ(scene.film.height, 10u);
    EXPECT_EQ(scene.settings.samples_per_pixel, 12u);
}

TEST(References, IdsMayBeInAnyScript) {
    const std::string text = scene_around("<bsdf id=\"Плитка №1\" type=\"conductor\"/><shape type=\"cube\"><ref "
                                          "id=\"Плитка №1\"/></shape>",
                                          "3.0.0", "");
    EXPECT_EQ(load_text(text).scene.materials[0].front.kind, BsdfKind::conductor);
}

TEST(UnknownParameters, WarnWithTheNearestName) {
    const std::string text = scene_around("<shape type=\"sphere\">\n<float name=\"raduis\" value=\"2\"/>\n"
                                          "</shape><emitter type=\"constant\"/>",
                                          "3.0.0", "");
    const LoadedScene loaded = load_text(text);
    EXPECT_THAT(loaded.warnings,
                ElementsAre(HasSubstr("scene.xml:4: unknown parameter \"raduis\" of shape \"sphere\"; did "
                                      "you mean \"radius\"?")));
    EXPECT_FLOAT_EQ(loaded.scene.spheres[0].radius, 1);
    EXPECT_THAT(error_of_text(text, {{}, true}), HasSubstr("scene.xml:4: unknown parameter \"raduis\""));
}

TEST(UnknownParameters, OfAnUnusedTexture) {
    EXPECT_THAT(load_text(scene_around("<texture type=\"bitmpa\"/><emitter type=\"constant\"/>")).warnings,
                Contains(AllOf(HasSubstr("scene.xml:3: unused texture"), HasSubstr("bitmap"))));
}

TEST(UnknownParameters, OfTheSceneAndUnusedObjects) {
    const std::string text = scene_around("<integer name=\"depth\" value=\"2\"/>\n<shape type=\"cube\">"
                                          "<film type=\"hdrfilm\"/></shape><emitter type=\"constant\"/>");
    EXPECT_THAT(load_text(text).warnings, testing::UnorderedElementsAre(HasSubstr("scene.xml:3: unknown parameter"),
                                                                        HasSubstr("scene.xml:4: <film> in shape")));
}

TEST(UnknownParameters, ThoseWithoutMeaningPassInSilence) {
    const std::string text =
        "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor type=\"perspective\" id=\"cam\" name=\"x\">"
        "<float name=\"near_clip\" value=\"0.1\"/><float name=\"farClip\" value=\"100\"/>"
        "<float name=\"focus_distance\" value=\"1\"/><sampler type=\"multijitter\"><integer name=\"seed\" "
        "value=\"3\"/></sampler><film type=\"hdrfilm\"><string name=\"file_format\" value=\"openexr\"/>"
        "<string name=\"pixelFormat\" value=\"rgb\"/><string name=\"component_format\" value=\"float32\"/>"
        "<boolean name=\"banner\" value=\"false\"/></film></sensor><shape type=\"sphere\" name=\"ball\"/>"
        "<emitter type=\"constant\"><float name=\"sampling_weight\" value=\"1\"/></emitter></scene>";
    EXPECT_THAT(load_text(text).warnings, IsEmpty());
    EXPECT_EQ(error_of_text(text, {{}, true}), "");
}

TEST(Warnings, UnusedBsdfsDoNoHarm) {
    const LoadedScene loaded = load_text(scene_around("<bsdf type=\"hair\" id=\"h\"/><emitter type=\"constant\"/>"));
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("the bsdf \"hair\" is not supported")));
}

TEST(Warnings, SceneWithoutEmitters) {
    EXPECT_THAT(load_text(scene_around("")).warnings, ElementsAre(HasSubstr("nothing in the scene emits")));
}

TEST(Warnings, SecondSensorIsIgnored) {
    const LoadedScene loaded =
        load_text(scene_around("<sensor type=\"perspective\"><float name=\"fov\" value=\"3\"/></sensor><emitter "
                               "type=\"constant\"/>"));
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("second <sensor>")));
    EXPECT_NE(loaded.scene.camera.fov, 3);
}

TEST(Warnings, SecondPartsOfASensorAreIgnored) {
    const LoadedScene loaded = load_text(
        "<scene version=\"3.0.0\"><sensor type=\"perspective\">\n<film type=\"hdrfilm\"><integer name=\"width\" "
        "value=\"40\"/><rfilter type=\"box\"/>\n<rfilter type=\"tent\"/></film>\n<film type=\"hdrfilm\"><integer "
        "name=\"width\" value=\"50\"/></film>\n<sampler type=\"independent\"><integer name=\"sample_count\" "
        "value=\"12\"/></sampler>\n<sampler type=\"independent\"><integer name=\"sample_count\" value=\"13\"/>"
        "</sampler></sensor><emitter type=\"constant\"/></scene>");
    EXPECT_THAT(
        loaded.warnings,
        UnorderedElementsAre(testing::MatchesRegex(".*scene.xml:3: a second <rfilter> is ignored.*scene.xml:2"),
                             testing::MatchesRegex(".*scene.xml:4: a second <film> is ignored.*scene.xml:2"),
                             testing::MatchesRegex(".*scene.xml:6: a second <sampler> is ignored.*scene.xml:5")));
    EXPECT_EQ(loaded.scene.film.width, 40u);
    EXPECT_EQ(loaded.scene.film.filter, FilmSettings::Filter::box);
    EXPECT_EQ(loaded.scene.settings.samples_per_pixel, 12u);
}

TEST(Warnings, SecondWrappedIntegratorIsIgnored) {
    const LoadedScene loaded = load_text(scene_around(
        "<integrator type=\"aov\">\n<integrator type=\"direct\"/>\n<integrator type=\"path\"/></integrator>"
        "<emitter type=\"constant\"/>"));
    EXPECT_THAT(loaded.warnings,
                Contains(HasSubstr("scene.xml:5: a second <integrator> is ignored; the one that counts "
                                   "is at")));
    EXPECT_EQ(loaded.scene.settings.max_depth, 2);
}

TEST(Values, BlanksSignsAndExponents) {
    for (const auto &[text, value] : std::vector<std::pair<std::string, double>>{
             {" 40 ", 40}, {"+4e1", 40}, {"4.0E+001", 40}, {"\t4e001\n", 40}, {".5", 0.5}, {"5.", 5}})
        EXPECT_DOUBLE_EQ(
            load_text("<scene version=\"3.0.0\"><sensor type=\"perspective\"><float name=\"fov\" value=\"" + text +
                      "\"/></sensor><shape type=\"cube\"/></scene>")
                .scene.camera.fov,
            value)
            << text;
}

TEST(Values, IntegersMayBeWrittenAsFloats) {
    const std::string text = "<scene version=\"3.0.0\"><sensor type=\"perspective\"><sampler type=\"independent\">"
                             "<integer name=\"sample_count\" value=\"1e3\"/></sampler></sensor><shape "
                             "type=\"cube\"/></scene>";
    EXPECT_EQ(load_text(text).scene.settings.samples_per_pixel, 1000u);
}

/// Lines are counted and entities replaced as in UTF-8.
TEST(Encodings, AreThoseOfXml) {
    const std::string umlaut = "\xfc", body = "<!-- " + std::string(40, '\xfc') +
                                              " -->\n\n<bsdf type=\"diffuse\" id=\"" + umlaut +
                                              "\"><float name=\"&word;\" value=\"1\"/></bsdf><shape "
                                              "type=\"cube\"><ref id=\"" +
                                              umlaut + "\"/></shape>" + constant_light + std::string(100, '\n');
    const std::string latin = "<!DOCTYPE scene [<!ENTITY word \"nonsense\">]>\n" + scene_around(body, "3.0.0", "");
    const auto wide = [&](bool is_big_endian, std::size_t bytes) {
        std::string result;
        for (const char letter : "\xfe" + latin) // whose first stands for the byte order mark
            for (std::size_t i = 0; i < bytes; ++i) {
                const std::size_t place = is_big_endian ? bytes - 1 - i : i;
                const bool is_mark = result.size() < bytes;
                result += place == 0 ? (is_mark ? '\xff' : letter) : place == 1 && is_mark ? '\xfe' : '\0';
            }
        return result;
    };
    for (const std::string &text : {"<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>" + latin, wide(false, 2),
                                    wide(true, 2), wide(true, 2).substr(2), wide(false, 4), wide(true, 4)}) {
        const LoadedScene loaded = load_text(text);
        EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("scene.xml:6: unknown parameter \"nonsense\"")));
        EXPECT_EQ(loaded.scene.materials.at(0).name, "\xc3\xbc");
    }
}

TEST(Values, IntegersWithoutBounds) {
    Element element;
    element.tag = "sampler";
    element.children.emplace_back();
    element.children[0].tag = "integer";
    element.children[0].attributes = {{"name", "count"}, {"value", "-9e15"}};
    const Declaration declaration{"", {{"count", Takes::integer, "0", ""}}};
    const ResolveReference resolve = [&](const Element &reference) -> const Element & { return reference; };
    Diagnostics diagnostics(false);
    EXPECT_EQ(Properties(element, declaration, resolve, diagnostics).integer("count"), -9000000000000000);
    element.children[0].attributes[1].second = "9e15";
    EXPECT_EQ(Properties(element, declaration, resolve, diagnostics).integer("count"), 9000000000000000);
}

} // namespace
} // namespace gradus
