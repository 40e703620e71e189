// Files of a few megabytes that ask for far more work or memory than their size: each is refused or loaded within
// seconds. What a limit does not stop here would take minutes, hours or all memory.
#include "runtime/io/diagnostics.h"
#include "runtime/io/mesh_files.h"
#include "tests/io/mesh_text.h"
#include "tests/io/scene_text.h"

#include <ctime>
#include <functional>

namespace gradus {
namespace {

using testing::HasSubstr;

std::string repeated(const std::string &text, std::size_t count) {
    std::string result;
    result.reserve(text.size() * count);
    for (std::size_t i = 0; i < count; ++i)
        result += text;
    return result;
}

std::string numbered(std::size_t count, const std::function<std::string(const std::string &)> &line) {
    std::string result;
    for (std::size_t i = 0; i < count; ++i)
        result += line(std::to_string(i));
    return result;
}

/// Each takes well below a second in a release build; what it guards against takes over a minute. The sanitizers slow
/// down by up to ten.
class Hostile : public testing::Test {
  protected:
    void SetUp() override { start_ = std::clock(); }
    void TearDown() override { EXPECT_LT(double(std::clock() - start_) / CLOCKS_PER_SEC, 20); }

  private:
    std::clock_t start_ = 0;
};

using HostileScene = Hostile;
using HostileMesh = Hostile;

std::string mesh_error(const std::function<void()> &parse) {
    try {
        parse();
    } catch (const SceneError &error) {
        return error.what();
    }
    return {};
}

/// Sixteen times sixteen times ... of nothing: no text grows, only time.
TEST_F(HostileScene, ParametersThatStandForNothingMany) {
    std::string text = "<default name=\"a0\" value=\"\"/>\n";
    for (int i = 1; i < 15; ++i)
        text += "<default name=\"a" + std::to_string(i) + "\" value=\"" + repeated("$a" + std::to_string(i - 1), 16) +
                "\"/>\n";
    EXPECT_EQ(error_of_text(scene_around(text + "<bsdf type=\"diffuse\" id=\"x$a14\"/>")), "");
}

/// Each value stays below a mebibyte; all of them do not.
TEST_F(HostileScene, ParametersThatExpandToGigabytes) {
    const std::string text = "<default name=\"a\" value=\"" + std::string(1000, 'x') +
                             "\"/><default name=\"b\" value=\"" + repeated("$a", 1000) + "\"/>\n" +
                             repeated("<bsdf type=\"diffuse\" id=\"$b\"/>\n", 10000);
    EXPECT_THAT(error_of_text(scene_around(text)), HasSubstr("--limits"));
}

TEST_F(HostileScene, ParameterNamesWithoutEnd) {
    EXPECT_THAT(error_of_text(scene_around("<default name=\"" + std::string(3000000, 'a') + "\" value=\"1\"/>")),
                HasSubstr("letters"));
    const std::string text = "<default name=\"" + std::string(100, 'a') +
                             "\" value=\"1\"/><bsdf type=\"diffuse\" id=\"" +
                             repeated("$" + std::string(99, 'a'), 30000) + "\"/>";
    EXPECT_THAT(error_of_text(scene_around(text)), HasSubstr("has no value"));
    EXPECT_LT(error_of_text(scene_around("<bsdf type=\"$" + std::string(3000000, 'a') + "\"/>")).size(), 5000u);
}

TEST_F(HostileScene, IncludesThatBranch) {
    TemporaryFolder folder;
    for (int i = 0; i < 15; ++i) {
        const std::string next = "<include filename=\"" + std::to_string(i + 1) + ".xml\"/>";
        folder.write(std::to_string(i) + ".xml", "<scene version=\"3.0.0\">" + repeated(next, 16) + "</scene>");
    }
    folder.write("15.xml", "<scene version=\"3.0.0\"/>");
    EXPECT_THAT(error_of((folder.path() / "0.xml").string()), HasSubstr("included; --limits"));
}

TEST_F(HostileScene, IncludesOfOneLargeFile) {
    TemporaryFolder folder;
    folder.write("large.xml", "<scene version=\"3.0.0\">" + repeated("<a/>", 250000) + "</scene>");
    const std::string path =
        folder.write("scene.xml", scene_around(repeated("<include filename=\"large.xml\"/>\n", 999)));
    LoadOptions options;
    options.limits.xml_bytes = 8 << 20;
    EXPECT_THAT(error_of(path, options), HasSubstr("MiB of XML; --limits"));
    options.limits.xml_bytes = ~0ull;
    options.limits.includes = 10;
    EXPECT_THAT(error_of(path, options), HasSubstr("more than 10 files"));
    options.limits.includes = 1000;
    options.limits.elements = 1000;
    options.limits.xml_bytes = 5 << 20;
    EXPECT_THAT(error_of(folder.write("few.xml", scene_around("<include filename=\"large.xml\"/>")), options),
                HasSubstr("more than 1000 elements"));
}

/// One waits for the next, and the last line of the file is the first that can be read.
TEST_F(HostileScene, IncludesThatWaitForEachOther) {
    TemporaryFolder folder;
    std::string text;
    for (int i = 1999; i > 1000; --i) { // of one length: the longest known name counts
        const std::string name = std::to_string(i), before = std::to_string(i - 1);
        folder.write(name + ".xml", "<scene version=\"3.0.0\"><default name=\"p" + name + "\" value=\"" +
                                        std::to_string(i + 1) + "\"/></scene>");
        text += "<include filename=\"$p" + before + ".xml\"/>\n";
    }
    text += numbered(20000, [](const std::string &i) { return "<default name=\"other" + i + "\" value=\"\"/>\n"; });
    EXPECT_EQ(error_of(folder.write("scene.xml", scene_around(text + "<default name=\"p1000\" value=\"1001\"/>"))), "");
}

TEST_F(HostileScene, ManyFoldersToSearch) {
    EXPECT_THAT(error_of_text(scene_around(repeated("<path value=\"/usr\"/>\n", 100000))),
                HasSubstr("folders to search"));
}

/// Names after ampersands, and declarations: each would be looked for to the end of the file.
TEST_F(HostileScene, EntitiesWithoutEnd) {
    const auto with_type = [](const std::string &declarations, const std::string &text) {
        return "<!DOCTYPE scene [" + declarations + "]>\n" + scene_around("<!-- " + text + " -->");
    };
    const std::string declaration = "<!ENTITY a \"1\">";
    for (const std::string &text :
         {with_type(declaration, repeated("&", 2000000)), with_type(declaration, repeated("&", 2000000) + ";"),
          with_type("<!ENTITY " + repeated("&", 1000000) + " \"1\">", repeated("&", 1000000) + ";"),
          with_type("<!ENTITY a SYSTEM '" + repeated("\"", 2000000) + "'>", "")})
        EXPECT_EQ(error_of_text(text), "");
    for (const std::string &text :
         {with_type(repeated("<!ENTITY", 300000), ""), with_type(repeated("<!ENTITY", 300000) + declaration, "")})
        EXPECT_THAT(error_of_text(text), HasSubstr("not well-formed XML"));
}

/// Each is reported with the nearest of as many names.
TEST_F(HostileScene, ManyOfWhatIsWrong) {
    EXPECT_THAT(error_of_text(scene_around(numbered(20000,
                                                    [](const std::string &i) {
                                                        return "<shape type=\"cube\"><ref id=\"nothing" + i +
                                                               "\"/></shape>\n";
                                                    }) +
                                           numbered(20000,
                                                    [](const std::string &i) {
                                                        return "<bsdf type=\"diffuse\" id=\"something" + i + "\"/>\n";
                                                    }))),
                HasSubstr("too many errors"));
    EXPECT_THAT(error_of_text(scene_around(
                    repeated("<shape type=\"ply\"><string name=\"filename\" value=\"no.ply\"/></shape>", 50000))),
                AllOf(HasSubstr("no.ply"), Not(HasSubstr("\n"))));
    EXPECT_THAT(
        error_of_text(scene_around(numbered(20000, [](const std::string &i) { return "<unknown" + i + "/>\n"; }))),
        HasSubstr("too many errors"));
    const LoadedScene loaded = load_text(scene_around(
        "<shape type=\"sphere\">" +
        numbered(20000, [](const std::string &i) { return "<float name=\"raduis" + i + "\" value=\"1\"/>\n"; }) +
        "</shape>"));
    EXPECT_EQ(loaded.warnings.size(), 101u);
    EXPECT_EQ(loaded.warnings.back(), "and 19901 more warnings");
}

TEST_F(HostileScene, ValuesWithoutEndAreNotRepeatedInMessages) {
    const std::string text(4000000, 'x');
    EXPECT_LT(error_of_text(scene_around("<shape type=\"" + text + "\"/>")).size(), 5000u);
    EXPECT_LT(
        error_of_text(scene_around("<shape type=\"obj\"><string name=\"filename\" value=\"" + text + "\"/></shape>"))
            .size(),
        5000u);
    EXPECT_LT(error_of_text(scene_around("<" + text + "/>")).size(), 5000u);
    EXPECT_LT(error_of_text("<scene version=\"" + text + "\"/>").size(), 5000u);
}

TEST_F(HostileScene, ReferencesInChains) {
    // Names that stand for names.
    std::string aliases = numbered(40000, [](const std::string &i) {
        return "<alias id=\"a" + std::to_string(std::stoi(i) + 1) + "\" as=\"a" + i + "\"/>\n";
    });
    EXPECT_THAT(
        error_of_text(scene_around(aliases + repeated("<shape type=\"cube\"><ref id=\"a0\"/></shape>\n", 40000))),
        HasSubstr("nothing has the id"));
    // Objects in objects, as deep as the stack is not, and twice as many with each.
    const std::string nested = numbered(20000, [](const std::string &i) {
        const std::string next = "<ref id=\"b" + std::to_string(std::stoi(i) + 1) + "\"/>";
        return "<bsdf type=\"twosided\" id=\"b" + i + "\">" + next + next + "</bsdf>\n";
    });
    EXPECT_THAT(error_of_text(scene_around(
                    nested + "<bsdf type=\"diffuse\" id=\"b20000\"/><shape type=\"cube\"><ref id=\"b0\"/></shape>")),
                HasSubstr("deep through <ref>s"));
}

/// Twice as many BSDFs with each.
TEST_F(HostileScene, BlendsOfBlends) {
    const auto nested = [](int depth) {
        std::string text = "<bsdf type=\"diffuse\" id=\"b0\"/>\n";
        for (int i = 1; i <= depth; ++i) {
            const std::string before = "<ref id=\"b" + std::to_string(i - 1) + "\"/>";
            text += "<bsdf type=\"blendbsdf\" id=\"b" + std::to_string(i) + "\">" + before + before +
                    "<float name=\"weight\" value=\"0.5\"/></bsdf>\n";
        }
        return scene_around(text + "<shape type=\"cube\"><ref id=\"b" + std::to_string(depth) + "\"/></shape>");
    };
    EXPECT_THAT(error_of_text(nested(39)), HasSubstr("a blend of more than 1000 BSDFs"));
    EXPECT_EQ(error_of_text(nested(9)), "");
}

/// A long spectrum is read once, not for each surface that has it.
TEST_F(HostileScene, OneSpectrumForManySurfaces) {
    std::string spectrum;
    for (int i = 0; i < 100000; ++i)
        spectrum += std::to_string(400 + i * 1e-3) + ":0.5,";
    const std::string bsdf =
        "<bsdf type=\"diffuse\" id=\"b\"><spectrum name=\"reflectance\" value=\"" + spectrum + "\"/></bsdf>";
    const std::string first =
        "<shape type=\"sphere\"><emitter type=\"area\" id=\"e\"><spectrum name=\"radiance\" value=\"" + spectrum +
        "\"/></emitter></shape>";
    const std::string other =
        "<shape type=\"sphere\"><bsdf type=\"twosided\"><ref id=\"b\"/></bsdf><ref id=\"e\"/></shape>\n";
    EXPECT_EQ(load_text(scene_around(bsdf + first + repeated(other, 5000))).scene.emitters.size(), 5001u);
}

/// Each has a part of the file, and all of it is read once.
TEST_F(HostileScene, OneMeshForManyMaterials) {
    TemporaryFolder folder;
    folder.write("m.obj", "mtllib m.mtl\n" + numbered(60000, [](const std::string &i) {
                              return "v 0 0 " + i + "\nv 1 0 0\nv 0 1 0\nusemtl m" + i + "\nf -1 -2 -3\n";
                          }));
    folder.write("m.mtl", numbered(59000, [](const std::string &i) { return "newmtl m" + i + "\n"; }));
    const std::string path = folder.write(
        "scene.xml", scene_around("<shape type=\"obj\"><string name=\"filename\" value=\"m.obj\"/></shape>", "0.6.0",
                                  constant_light));
    EXPECT_EQ(load_scene(path).scene.shapes.size(), 59001u);
}

/// Several files of meshes are kept; what is too much is told once.
TEST_F(HostileScene, SharedMeshesInTurn) {
    TemporaryFolder folder;
    std::string shapes;
    for (const std::string name : {"a.serialized", "b.serialized"}) {
        std::string padded = serialized_file({folded_square()}, {});
        folder.write(name, padded.insert(padded.size() - 12, 1 << 20, '\0'));
        shapes += "<shape type=\"serialized\"><string name=\"filename\" value=\"" + name + "\"/></shape>\n";
    }
    const std::string path = folder.write("scene.xml", scene_around(repeated(shapes, 50)));
    LoadOptions options;
    options.limits.mesh_bytes = 3 << 20;
    EXPECT_EQ(error_of(path, options), "");
    options.limits.mesh_bytes = 1 << 20;
    const std::string error = error_of(path, options);
    EXPECT_THAT(error, HasSubstr("scene.xml:3: the shapes up to this one read more"));
    EXPECT_EQ(error.find("the shapes up to"), error.rfind("the shapes up to"));
}

/// The numbers of a rough coat take 15 ms.
TEST_F(HostileScene, RoughCoatsThatAreAlike) {
    EXPECT_EQ(error_of_text(scene_around(repeated("<bsdf type=\"roughplastic\"/>\n", 20000) +
                                         "<shape type=\"cube\"><bsdf type=\"roughplastic\"/></shape>")),
              "");
}

/// A map around a blend copies all of it.
TEST_F(HostileScene, MapsAroundBlends) {
    std::string weights, parts;
    for (int i = 0; i < 500; ++i) {
        weights += "0.001 ";
        parts += "<bsdf type=\"diffuse\"/>";
    }
    const std::string mixture = "<bsdf type=\"mixturebsdf\" id=\"b\"><string name=\"weights\" value=\"" + weights +
                                "\"/>" + parts + "</bsdf>\n";
    const std::string bump = "<shape type=\"cube\"><bsdf type=\"bumpmap\"><texture type=\"checkerboard\"/>"
                             "<ref id=\"b\"/></bsdf></shape>\n";
    const std::string error = error_of_text(scene_around(mixture + repeated(bump, 3000), "0.6.0"));
    EXPECT_THAT(error, HasSubstr("the blends up to this one hold more than 200000 BSDFs; --limits"));
    EXPECT_EQ(error.find("the blends up to"), error.rfind("the blends up to"));
    EXPECT_EQ(error_of_text(scene_around(mixture + repeated(bump, 100), "0.6.0")), "");
}

TEST_F(HostileScene, OneMeshForManyShapes) {
    TemporaryFolder folder;
    folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" + repeated("# nothing\n", 400000));
    const std::string path = folder.write(
        "scene.xml",
        scene_around(repeated("<shape type=\"obj\"><string name=\"filename\" value=\"m.obj\"/></shape>\n", 30000)));
    LoadOptions options;
    options.limits.mesh_bytes = 64 << 20;
    EXPECT_THAT(error_of(path, options), HasSubstr("MiB of meshes; --limits"));
    options.limits = {};
    options.limits.geometry_bytes = 300;
    EXPECT_THAT(error_of(path, options), HasSubstr("of vertices and triangles; --limits"));
}

TEST_F(HostileMesh, PlyElementsWithoutProperties) {
    const std::string header = "ply\nformat binary_little_endian 1.0\n";
    EXPECT_THAT(mesh_error([&] {
                    parse_ply(header + repeated("element a 1000000\n", 200000) + "end_header\n" +
                                  std::string(1000000, '\0'),
                              "m.ply");
                }),
                HasSubstr("elements are declared"));
    EXPECT_EQ(mesh_error([&] { parse_ply(header + "element a 9000000000000000\nend_header\n", "m.ply"); }), "");
}

/// Two kinds of vertices with unlike properties, and faces that name the second kind's.
TEST_F(HostileMesh, PlyWithTwoElementsOfOneName) {
    const std::string head = "ply\nformat ascii 1.0\n", xyz = "property float x\nproperty float y\nproperty float z\n";
    const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
    EXPECT_THAT(mesh_error([&] {
                    parse_ply(head + "element vertex 1\n" + xyz +
                                  "property float nx\nproperty float ny\nproperty float nz\n" + "element vertex 3\n" +
                                  xyz + faces + "end_header\n0 0 0 0 0 1\n1 0 0\n0 1 0\n0 0 1\n3 1 2 3\n",
                              "m.ply");
                }),
                HasSubstr("m.ply:10: a second element \"vertex\""));
    EXPECT_THAT(mesh_error([&] { parse_ply(head + faces + faces + "end_header\n", "m.ply"); }),
                HasSubstr("second element"));
}

TEST_F(HostileMesh, PlyCountsThatDisagree) {
    const std::string head = "ply\nformat binary_little_endian 1.0\n",
                      xyz = "property float x\nproperty float y\nproperty float z\n";
    EXPECT_THAT(mesh_error([&] {
                    parse_ply(head + "element vertex 2000000000\n" + xyz + "end_header\n" + std::string(1000, '\0'),
                              "m.ply");
                }),
                HasSubstr("more than the file holds"));
    std::string list = head + "element face 1\nproperty list uint uint vertex_indices\nend_header\n";
    append_bytes<std::uint32_t>(list, 0xffffffffu);
    EXPECT_THAT(mesh_error([&] { parse_ply(list, "m.ply"); }), HasSubstr("longer than the rest"));
}

TEST_F(HostileMesh, ObjWithOnePositionAndManyNormals) {
    std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    constexpr int count = 100000;
    for (int i = 1; i <= count; ++i)
        text += "vn 0 0 " + std::to_string(i) + "\n";
    for (int i = 1; i <= count; ++i)
        text += "f 1//" + std::to_string(i) + " 2//1 3//1\n";
    text += text.substr(text.find("f 1//1 ")); // once more: no new vertices
    const Mesh mesh = parse_obj(text, "m.obj");
    ASSERT_EQ(mesh.positions.size(), std::size_t(count + 2));
    ASSERT_EQ(mesh.triangles.size(), std::size_t(2 * count));
    for (std::size_t i = 0; i < std::size_t(count); ++i) {
        ASSERT_EQ(mesh.triangles[i], mesh.triangles[i + count]);
        ASSERT_EQ(mesh.normals[mesh.triangles[i][0]].z, float(i + 1));
    }
}

std::string serialized_with(const std::string &payload) {
    std::string file("\x1c\x04\x04\x00", 4);
    file += deflated(payload);
    append_bytes<std::uint64_t>(file, 0);
    append_bytes<std::uint32_t>(file, 1);
    return file;
}

TEST_F(HostileMesh, SerializedNameWithoutEnd) {
    std::string payload;
    append_bytes<std::uint32_t>(payload, 0x1000);
    payload += std::string(20000000, 'a');
    EXPECT_THAT(mesh_error([&] { parse_serialized(serialized_with(payload), "m", 0); }), HasSubstr("has no end"));
}

TEST_F(HostileMesh, SerializedStreamThatUnfoldsAThousandfold) {
    std::string payload;
    append_bytes<std::uint32_t>(payload, 0x1000);
    payload += '\0';
    constexpr std::uint64_t vertices = 6'000'000;
    append_bytes<std::uint64_t>(payload, vertices);
    append_bytes<std::uint64_t>(payload, 0);
    payload += std::string(vertices * 12, '\0');
    const std::string file = serialized_with(payload);
    ASSERT_LT(file.size(), 200000u);
    EXPECT_THAT(mesh_error([&] { parse_serialized(file, "m", 0); }), HasSubstr("unfolds to 68 MiB"));
    EXPECT_EQ(mesh_error([&] {
                  EXPECT_EQ(parse_serialized(file, "m", 0, LoadLimits().times(10)).unfolded_bytes, vertices * 12);
              }),
              "");
}

} // namespace
} // namespace gradus
