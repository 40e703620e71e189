// Materials of OBJ files: BSDFs by the names of their `usemtl` lines, from scene files of 0.x and from MTL files.
#include "tests/io/scene_print.h"
#include "tests/io/scene_text.h"

#include <map>

namespace gradus {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class ObjMaterials : public testing::Test {
  protected:
    LoadedScene load(const std::string &inside, const std::string &version = "0.6.0") const {
        return load_scene(scene(inside, version), options_);
    }
    std::string error(const std::string &inside = "") const { return error_of(scene(inside, "0.6.0"), options_); }
    std::string scene(const std::string &inside, const std::string &version) const {
        return folder_.write(
            "scene.xml",
            scene_around("<bsdf type=\"diffuse\" id=\"b\"><rgb name=\"reflectance\" value=\"0.2 0.2 0.2\"/>"
                         "</bsdf>\n<shape type=\"obj\"><string name=\"filename\" value=\"meshes/a.obj\"/>" +
                             inside + "</shape>",
                         version, constant_light));
    }
    void write_mtl(const std::string &text) const { folder_.write("meshes/a.mtl", text); }

    TemporaryFolder folder_;
    LoadOptions options_;
};

/// Triangles by the red of what they reflect.
std::map<float, std::size_t> triangles(const Scene &scene) {
    std::map<float, std::size_t> found;
    for (const Shape &shape : scene.shapes)
        found[scene.materials.at(shape.material).front.reflectance.r] +=
            scene.meshes.at(shape.geometry).triangles.size();
    return found;
}
using Found = std::map<float, std::size_t>;

TEST_F(ObjMaterials, HaveBsdfsOfTheirOwnIn0x) {
    folder_.write("meshes/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\n  usemtl red one \nf 2 4 3\nf 1 2 4\n"
                                  "usemtl none\nusemtl blue\r\nf 1 2 3\nusemtl red one\nf 1 4 3\n");
    const std::string red = red_diffuse.substr(0, 5) + " name=\"red one\"" + red_diffuse.substr(5);
    const std::string blue = "<ref name=\"blue\" id=\"b\"/>";
    const LoadedScene two = load(red + blue);
    EXPECT_THAT(two.warnings, IsEmpty());
    EXPECT_EQ(triangles(two.scene), (Found{{0.5f, 4}, {0.2f, 1}})) << "the first is diffuse 0.5";
    EXPECT_EQ(two.scene.shapes.size(), 3u);
    EXPECT_EQ(triangles(load(red + "<ref id=\"b\"/>").scene), (Found{{0.5f, 3}, {0.2f, 2}}));
    EXPECT_EQ(
        triangles(load("<bsdf type=\"diffuse\" name=\"bsdf\"><rgb name=\"reflectance\" value=\"0.9 0 0\"/></bsdf>" +
                       red + blue)
                      .scene),
        (Found{{0.9f, 1}, {0.5f, 3}, {0.2f, 1}}));
    EXPECT_EQ(triangles(load("<ref id=\"b\"/><ref name=\"none\" id=\"b\"/>").scene), (Found{{0.2f, 5}}));
    const LoadedScene other = load(red + blue + "<bsdf type=\"diffuse\" name=\"none\"/>");
    EXPECT_THAT(other.warnings, ElementsAre(HasSubstr("no face of the file has the material \"none\"")));
    EXPECT_EQ(triangles(other.scene), triangles(two.scene));
    EXPECT_EQ(triangles(load(blue).scene), (Found{{0.5f, 4}, {0.2f, 1}})) << "one BSDF, of one of the materials";
    EXPECT_EQ(triangles(load("<ref name=\"of the shape\" id=\"b\"/>").scene), (Found{{0.2f, 5}}))
        << "one BSDF, whose name says nothing";
    EXPECT_THAT(error_of(scene(red + "\n" + blue, "3.0.0")),
                AllOf(HasSubstr("scene.xml:5"), HasSubstr("second; only in files of 0.x")));
}

const std::string two_materials = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n"
                                  "usemtl one\nf 1/1 2/2 3/3\nusemtl two\nf 2/2 4/4 3/3\nf 1/1 2/2 4/4\n";

// The file's own BSDFs are those that somebody would have written for each material.
TEST_F(ObjMaterials, OfLibrariesAreTheBsdfsThatTheySay) {
    folder_.write("meshes/a.obj", two_materials);
    folder_.write("meshes/kd.pfm", std::string("PF\n1 1\n-1\n") + std::string(12, '\0'));
    const std::string filename = "<string name=\"filename\" value=\"kd.pfm\"/>";
    const std::string kd = "<srgb name=\"reflectance\" value=\"0.8 0.4 0.2\"/>";
    const auto bsdf = [](const char *type, const std::string &inside) {
        return std::string("<bsdf type=\"") + type + "\">" + inside + "</bsdf>";
    };
    const auto texture = [&](const std::string &name, const std::string &more = "") {
        return "<texture type=\"bitmap\" name=\"" + name + "\">" + filename + more + "</texture>";
    };
    const std::string raised = texture("bump", "<float name=\"gamma\" value=\"1\"/>");
    const std::vector<std::pair<std::string, std::string>> cases = {
        {"Kd 0.8 0.4 0.2", bsdf("diffuse", kd)},
        {"Kd 0.8 0.4 0.2 # of wood\r\n\tillum 1\r\nKa 1 1 1\r\nrefl a b c", bsdf("diffuse", kd)},
        {"Kd 2 0.4 -1", bsdf("diffuse", "<srgb name=\"reflectance\" value=\"1 0.4 0\"/>")},
        {"Kd 0.5", bsdf("diffuse", "<srgb name=\"reflectance\" value=\"0.5\"/>")},
        {"", bsdf("diffuse", "<rgb name=\"reflectance\" value=\"0\"/>")},
        {"Kd 0.8 0.4 0.2\nKs 0.1 0.1 0.2\nNs 20\nillum 2",
         bsdf("phong", "<srgb name=\"diffuseReflectance\" value=\"0.8 0.4 0.2\"/><srgb name=\"specularReflectance\" "
                       "value=\"0.1 0.1 0.2\"/><float name=\"exponent\" value=\"20\"/>")},
        {"Kd 0.8 0.4 0.2\nmap_Ks kd.pfm\nNs 20\nillum 2",
         bsdf("phong", "<srgb name=\"diffuseReflectance\" value=\"0.8 0.4 0.2\"/>" + texture("specularReflectance") +
                           "<float name=\"exponent\" value=\"20\"/>")},
        {"Kd 0.8 0.4 0.2\nKs 0.1 0.1 0.2\nillum 2", bsdf("diffuse", kd)},
        {"Kd 0.8 0.4 0.2\nKs 0 0 0\nNs 20\nillum 2", bsdf("diffuse", kd)},
        {"illum 4", bsdf("dielectric", "")},
        {"illum 6", bsdf("dielectric", "")},
        {"illum 7", bsdf("dielectric", "")},
        {"illum 9", bsdf("dielectric", "")},
        {"illum 5", bsdf("conductor", "<string name=\"material\" value=\"Al\"/>")},
        {"illum 8", bsdf("conductor", "<string name=\"material\" value=\"Al\"/>")},
        {"map_Kd kd.pfm", bsdf("diffuse", texture("reflectance"))},
        {"map_Kd \"kd.pfm\"", bsdf("diffuse", texture("reflectance"))},
        {"map_Kd C:\\pictures\\kd.pfm", bsdf("diffuse", texture("reflectance"))},
        {"map_Kd ../meshes/kd.pfm\nKd 0.8 0.4 0.2", bsdf("diffuse", kd)},
        {"Kd 0.8 0.4 0.2\nbump kd.pfm", bsdf("bumpmap", raised + bsdf("diffuse", kd))},
        {"Kd 0.8 0.4 0.2\nd 0.25", bsdf("mask", "<float name=\"opacity\" value=\"0.25\"/>" + bsdf("diffuse", kd))},
        {"Kd 0.8 0.4 0.2\nd -halo 0.25",
         bsdf("mask", "<float name=\"opacity\" value=\"0.25\"/>" + bsdf("diffuse", kd))},
        {"Kd 0.8 0.4 0.2\nd 0.25\nd 1", bsdf("diffuse", kd)},
        {"Kd 0.8 0.4 0.2\nmap_d kd.pfm\nbump kd.pfm",
         bsdf("mask", texture("opacity") + bsdf("bumpmap", raised + bsdf("diffuse", kd)))},
    };
    const auto of_two = [](std::string text) { return text.insert(text.find(' '), " name=\"two\""); };
    for (const auto &[mtl, said] : cases) {
        write_mtl("Kd 1 1 1\nnewmtl one\nKd 0.1 0.2 0.3\nNs 7\nillum 2\nKs 1 1 1\nnewmtl two\n" + mtl + "\n");
        const std::string one = "<bsdf type=\"phong\" name=\"one\"><srgb name=\"diffuseReflectance\" value=\"0.1 0.2 "
                                "0.3\"/><srgb name=\"specularReflectance\" value=\"1 1 1\"/><float name=\"exponent\" "
                                "value=\"7\"/></bsdf>";
        const LoadedScene loaded = load("");
        EXPECT_THAT(loaded.warnings, IsEmpty()) << mtl;
        folder_.write("kd.pfm", std::string("PF\n1 1\n-1\n") + std::string(12, '\0'));
        EXPECT_EQ(ScenePrint(loaded.scene).text(), ScenePrint(load(one + of_two(said)).scene).text()) << mtl;
        EXPECT_EQ(ScenePrint(load("<boolean name=\"load_materials\" value=\"true\"/>", "3.0.0").scene).text(),
                  ScenePrint(loaded.scene).text());
    }
}

TEST_F(ObjMaterials, OfLibrariesCountWhereTheShapeHasNoBsdfForThem) {
    folder_.write("meshes/a.obj", two_materials);
    write_mtl("newmtl one\nKd 1 0 0\nnewmtl two\nKd 0 1 0\nnewmtl three\nKd 0 0 1\n");
    const std::string no = "<boolean name=\"loadMaterials\" value=\"false\"/>", blue = "<ref name=\"two\" id=\"b\"/>";
    EXPECT_EQ(triangles(load("").scene), (Found{{1, 1}, {0, 2}}));
    EXPECT_EQ(triangles(load(blue).scene), (Found{{1, 1}, {0.2f, 2}}));
    EXPECT_EQ(triangles(load("<ref id=\"b\"/>").scene), (Found{{0.2f, 3}}));
    EXPECT_EQ(triangles(load("<ref id=\"b\"/><ref name=\"none\" id=\"b\"/>").scene), (Found{{0.2f, 3}}));
    EXPECT_EQ(triangles(load(no).scene), (Found{{0.5f, 3}}));
    EXPECT_EQ(triangles(load(no + blue).scene), (Found{{0.2f, 3}}));
    EXPECT_EQ(triangles(load("", "3.0.0").scene), (Found{{0.5f, 3}}));
    EXPECT_EQ(load("", "3.0.0").scene.shapes.size(), 1u);
    write_mtl("newmtl one\nKd 1 0 0\nnewmtl two\nKd 0 1 0\nnewmtl one\nKd 0 0 1\n");
    EXPECT_EQ(triangles(load("").scene), (Found{{0, 3}})) << "the last of a name counts";
}

TEST_F(ObjMaterials, OneLineMayNameSeveralLibraries) {
    const std::string faces = two_materials.substr(two_materials.find('\n'));
    folder_.write("meshes/b.mtl", "newmtl two\nKd 0 1 0\n");
    write_mtl("newmtl one\nKd 1 0 0\n");
    folder_.write("meshes/a.obj", "mtllib a.mtl  b.mtl" + faces);
    const LoadedScene both = load("");
    EXPECT_THAT(both.warnings, IsEmpty());
    EXPECT_EQ(triangles(both.scene), (Found{{1, 1}, {0, 2}}));
    folder_.write("meshes/a.obj", "mtllib a.mtl gone.mtl b.mtl" + faces);
    const LoadedScene lacks = load("");
    EXPECT_THAT(lacks.warnings, ElementsAre(HasSubstr("a.obj:1: cannot find the material library \"gone.mtl\"")));
    EXPECT_EQ(triangles(lacks.scene), (Found{{1, 1}, {0, 2}}));
    folder_.write("meshes/a.obj", "mtllib a.mtl b.mtl" + faces);
    folder_.write("meshes/a.mtl b.mtl", "newmtl one\nKd 1 0 0\nnewmtl two\nKd 1 0 0\n");
    EXPECT_EQ(triangles(load("").scene), (Found{{1, 3}})) << "a file of the very name goes before";
    folder_.write("meshes/a.obj", "mtllib gone c.mtl" + faces);
    EXPECT_THAT(load("").warnings, Contains(HasSubstr("cannot find the material library \"gone c.mtl\"")));
}

/// A line `newmtl` that names nothing is no material of faces that have none.
TEST_F(ObjMaterials, WithoutANameAreNobodys) {
    folder_.write("meshes/a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl one\nf 1 2 3\nf 1 3 2\n");
    for (const char *text : {"newmtl\nKd 0 1 0\nnewmtl one\nKd 1 0 0\n", "newmtl\rKd 0 1 0\r\nnewmtl one\rKd 1 0 0"}) {
        write_mtl(text);
        EXPECT_EQ(triangles(load("").scene), (Found{{1, 2}, {0.5f, 1}}));
    }
}

TEST_F(ObjMaterials, PartsOfAFileByNumberAreWarnedOf) {
    folder_.write("meshes/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_THAT(load("<integer name=\"shapeIndex\" value=\"1\"/>").warnings,
                ElementsAre(AllOf(HasSubstr("scene.xml:4: "), HasSubstr("shape_index of an OBJ file is not read"))));
}

TEST_F(ObjMaterials, WhatLibrariesLackIsWarnedOf) {
    folder_.write("meshes/a.obj", two_materials);
    const LoadedScene without = load("");
    EXPECT_THAT(without.warnings,
                ElementsAre(AllOf(HasSubstr("a.obj:1: "), HasSubstr("cannot find the material library \"a.mtl\"")),
                            AllOf(HasSubstr("scene.xml:4: "), HasSubstr(" has one, two: "))));
    EXPECT_EQ(without.scene.shapes.size(), 1u);
    EXPECT_THAT(load("<ref id=\"b\"/>").warnings, IsEmpty());
    EXPECT_THAT(load("<boolean name=\"loadMaterials\" value=\"false\"/>").warnings, IsEmpty());
    EXPECT_THAT(load("", "3.0.0").warnings, IsEmpty());
    write_mtl("newmtl two\nmap_Kd -s 2 2 -clamp on -mm 0 1 -o 1 a b.png\nKd 1 1 1\n");
    folder_.write("meshes/a b.png", "");
    const LoadedScene half = load("");
    EXPECT_THAT(half.warnings, ElementsAre(HasSubstr("option -clamp"), HasSubstr("option -mm"), HasSubstr("option -o"),
                                           HasSubstr("option -s"), HasSubstr(" has one: ")));
    EXPECT_EQ(triangles(half.scene), (Found{{0.5f, 1}, {1, 2}}));
    folder_.write("meshes/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_THAT(load("").warnings, IsEmpty());
}

TEST_F(ObjMaterials, MistakesInLibrariesHaveTheirLine) {
    folder_.write("meshes/a.obj", two_materials);
    for (const auto &[line, message] : std::vector<std::pair<std::string, std::string>>{
             {"Kd 1 x 1", "Kd needs three numbers"},
             {"Kd 1 1", "Kd needs three numbers"},
             {"Ks spectral a.rfl", "Ks needs three numbers"},
             {"Ns", "Ns needs a number"},
             {"d -halo", "d needs a number"},
             {"illum two", "illum needs a number"},
             {"map_Kd", "map_Kd needs a file's name"},
             {"map_Kd -clamp on", "map_Kd needs a file's name"},
             {"map_Kd /none/gone.png", "cannot find the file \"/none/gone.png\""}}) {
        write_mtl("newmtl one\nnewmtl two\n" + line + "\n");
        EXPECT_THAT(error(), AllOf(HasSubstr("a.mtl:3: "), HasSubstr(message))) << line;
    }
    write_mtl("newmtl three\nmap_Kd gone.png\n");
    EXPECT_EQ(error(), "") << "no face has it";
    options_.limits.mesh_bytes = two_materials.size() + 10;
    EXPECT_THAT(error(), AllOf(HasSubstr("scene.xml:4: "), HasSubstr("MiB of meshes")));
}

TEST_F(ObjMaterials, LibrariesAreNoWayToOtherFiles) {
    folder_.write("meshes/a.obj", two_materials);
    folder_.write("meshes/secret", "newmtl one\nmap_Kd hunter2\n");
    std::filesystem::create_symlink("secret", folder_.path() / "meshes/a.mtl");
    EXPECT_THAT(load("").warnings, ElementsAre(HasSubstr("is called .mtl"), HasSubstr(" has one, two: ")));
    std::filesystem::remove(folder_.path() / "meshes/a.mtl");
    folder_.write("a.mtl", "newmtl one\nmap_Kd hunter2\n");
    std::filesystem::create_symlink("../a.mtl", folder_.path() / "meshes/b.mtl");
    std::string own = two_materials;
    folder_.write("meshes/a.obj", own.replace(own.find("a.mtl"), 5, "b.mtl"));
    folder_.write("meshes/scene.xml", scene_around("<shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/>"
                                                   "</shape>",
                                                   "0.6.0", constant_light));
    options_.confined = true;
    EXPECT_THAT(load_scene((folder_.path() / "meshes/scene.xml").string(), options_).warnings,
                ElementsAre(HasSubstr("cannot find the material library \"b.mtl\""), Not(HasSubstr("hunter2"))));
    options_.confined = false;
    EXPECT_THAT(error_of((folder_.path() / "meshes/scene.xml").string(), options_), HasSubstr("hunter2"));
}

// One file for all of its parts, which is read once and counts once.
TEST_F(ObjMaterials, OfABrokenFileAreToldOnce) {
    folder_.write("meshes/a.obj", two_materials + "f 1 2 9\n");
    write_mtl("newmtl one\nnewmtl two\n");
    const std::string said = error();
    EXPECT_THAT(said, HasSubstr("a.obj:15: face index out of range"));
    EXPECT_EQ(said.find("a.obj:15"), said.rfind("a.obj:15"));
    folder_.write("meshes/a.obj", two_materials);
    options_.limits.mesh_bytes = two_materials.size() + 30;
    EXPECT_EQ(error(), "");
}

} // namespace
} // namespace gradus
