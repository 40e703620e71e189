// Mesh files written here and read back, and broken ones.
#include "runtime/io/diagnostics.h"
#include "runtime/io/mesh_files.h"
#include "tests/io/mesh_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gradus {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Triangle = std::array<std::uint32_t, 3>;

template <typename Function>
std::string message_of(Function &&function) {
    try {
        function();
    } catch (const SceneError &error) {
        return error.what();
    }
    return {};
}
std::string obj_error(const std::string &text) {
    return message_of([&] { parse_obj(text, "m.obj"); });
}
std::string ply_error(const std::string &text) {
    return message_of([&] { parse_ply(text, "m.ply"); });
}
std::string serialized_error(const std::string &data, std::uint64_t index = 0) {
    return message_of([&] { parse_serialized(data, "m.serialized", index); });
}

void expect_same(const Mesh &actual, const Mesh &expected) {
    EXPECT_EQ(actual.positions, expected.positions);
    EXPECT_EQ(actual.normals, expected.normals);
    EXPECT_EQ(actual.texcoords, expected.texcoords);
    EXPECT_EQ(actual.triangles, expected.triangles);
}

TEST(Obj, PositionsOnly) {
    const Mesh mesh = parse_obj("# comment\nv 0 0 0\nv 1 0 0 1.0\r\nv  +0 1e0 -0.5\nf 1 2 3\n", "m.obj");
    EXPECT_THAT(mesh.positions, ElementsAre(Vector3{0, 0, 0}, Vector3{1, 0, 0}, Vector3{0, 1, -0.5f}));
    EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}));
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_TRUE(mesh.texcoords.empty());
}

TEST(Obj, AByteOrderMarkIsNoPartOfTheFirstLine) {
    const Mesh mesh = parse_obj("\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "m.obj");
    EXPECT_THAT(mesh.positions, ElementsAre(Vector3{0, 0, 0}, Vector3{1, 0, 0}, Vector3{0, 1, 0}));
}

TEST(Obj, EndsOfLinesOfEverySystem) {
    const std::string lines[] = {"v 0 0 0", "v 1 0 0", "v 0 1 0", "f 1 2 3", "f 1 2 x"};
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        std::string text;
        for (int i = 0; i < 4; ++i)
            text += lines[i] + end;
        EXPECT_EQ(parse_obj(text, "m.obj").triangles.size(), 1u);
        try {
            parse_obj(text + lines[4] + end, "m.obj");
            ADD_FAILURE() << "no error";
        } catch (const SceneError &error) {
            EXPECT_THAT(error.what(), ::testing::HasSubstr("m.obj:5"));
        }
    }
}

TEST(Obj, CornersOfEveryForm) {
    const std::string head = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0.5 0.25\nvt 1 1 0\nvn 0 0 1\nvn 1 0 0\n";
    const Mesh full = parse_obj(head + "f 1/1/1 2/2/1 3/1/2", "m.obj");
    EXPECT_THAT(full.texcoords, ElementsAre(std::array{0.5f, 0.25f}, std::array{1.0f, 1.0f}, std::array{0.5f, 0.25f}));
    EXPECT_THAT(full.normals, ElementsAre(Vector3{0, 0, 1}, Vector3{0, 0, 1}, Vector3{1, 0, 0}));
    const Mesh normals = parse_obj(head + "f 1//2 2//2 3//2", "m.obj");
    EXPECT_TRUE(normals.texcoords.empty());
    EXPECT_EQ(normals.normals[0], (Vector3{1, 0, 0}));
    const Mesh texcoords = parse_obj(head + "f 1/2 2/2 3/2", "m.obj");
    EXPECT_TRUE(texcoords.normals.empty());
    EXPECT_EQ(texcoords.texcoords[0], (std::array{1.0f, 1.0f}));
    const Mesh relative = parse_obj(head + "f -3/-2/-1 -2/-2/-1 -1/-2/-1", "m.obj");
    EXPECT_THAT(relative.positions, ElementsAre(Vector3{0, 0, 0}, Vector3{1, 0, 0}, Vector3{1, 1, 0}));
    EXPECT_EQ(relative.texcoords[2], (std::array{0.5f, 0.25f}));
    EXPECT_EQ(relative.normals[2], (Vector3{1, 0, 0}));
}

TEST(Obj, PolygonsAreFansAndCornersAreShared) {
    const Mesh mesh = parse_obj("o thing\ng group\nusemtl x\ns off\nv 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 2 0\n"
                                "f 1 2 3 4 5\nf 1 3 2 # other side\n",
                                "m.obj");
    EXPECT_EQ(mesh.positions.size(), 5u);
    EXPECT_THAT(mesh.triangles,
                ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{0, 3, 4}, Triangle{0, 2, 1}));
}

// Parts are the meshes of files that have their faces alone.
TEST(Obj, MeshesOfSomeMaterials) {
    const std::string lists = "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 2 0\nvt 0 0\nvt 1 0\n";
    const std::string first = "f 1 2 3\n", pentagon = "f 1 2 3 4 5\n", textured = "f 3/1 4/2 5/1\nf 5/1 4/2 2/2\n";
    const std::string text =
        lists + first + "usemtl none\nusemtl a\n" + pentagon + textured + "usemtl b b\n" + first + "usemtl a\n" + first;
    const ObjFile file(text, "m.obj");
    const auto expect = [&](const FacesOf &faces, const std::string &alone) {
        const Mesh part = file.mesh(faces), whole = parse_obj(lists + alone, "m.obj");
        EXPECT_EQ(part.positions, whole.positions) << alone;
        EXPECT_EQ(part.texcoords, whole.texcoords) << alone;
        EXPECT_EQ(part.triangles, whole.triangles) << alone;
    };
    expect({{"a"}, false}, pentagon + textured + first);
    expect({{"b b"}, false}, first);
    expect({{""}, false}, first);
    expect({{"a"}, true}, first + first);
    expect({{"a", ""}, false}, first + pentagon + textured + first);
    expect({{"none"}, false}, "");
    expect({}, first + pentagon + textured + first + first);
    EXPECT_TRUE(file.has_material("b b"));
    EXPECT_FALSE(file.has_material("none"));
    EXPECT_THAT(names_in_obj(text).materials, ElementsAre("", "a", "b b"));
    // What the reader takes for no face is none, and lines that go on are one.
    EXPECT_THAT(names_in_obj(lists + "\vf 1 2 3\nv 0 0 \\\n0\nusemtl a\n f 1 2 3\nmtllib a b.mtl\nf 1 2 \\\nusemtl b\n")
                    .materials,
                ElementsAre("a"));
    EXPECT_EQ(names_in_obj("v 0 0 \\\r\n0\r\nmtllib a b.mtl \r\n").libraries.at(0).name, "a b.mtl");
    EXPECT_EQ(names_in_obj("v 0 0 \\\r\n0\r\nmtllib a b.mtl \r\n").libraries.at(0).line, 3u);
}

TEST(Obj, LinesGoOnAfterABackslash) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        const auto lines = [&](std::initializer_list<const char *> all) {
            std::string text;
            for (const char *line : all)
                text += line + end;
            return text;
        };
        const Mesh mesh = parse_obj(
            lines({"# C:\\", "v 0 \\", "0 0", "v 1 0 0", "v 1 1 0", "v 0 1 0", "mtllib D:\\", "f 1 2\\", "\\", "3 4"}),
            "m.obj");
        EXPECT_EQ(mesh.positions.size(), 4u);
        EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
        const std::string head = lines({"v 0 0 0", "v 1 0 0", "v 1 1 0"});
        EXPECT_THAT(obj_error(head + lines({"f 1 \\", "2 3", "f 1 2 9"})), HasSubstr("m.obj:6: face index"));
        EXPECT_THAT(parse_obj(head + "f 1 2 \\", "m.obj").triangles, ElementsAre(Triangle{0, 1, 1}))
            << "where the file ends";
    }
}

TEST(Obj, PositionsWithSeveralNormalsAreSplit) {
    const Mesh mesh = parse_obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nvn 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//1\n"
                                "f 1//2 3//2 4//2\nf 1//1 3//1 4//2\n",
                                "m.obj");
    EXPECT_EQ(mesh.positions.size(), 6u); // 3, then 1 and 3 once more and 4
    EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{3, 4, 5}, Triangle{0, 2, 5}));
}

/// They come to triangles without area, which are counted where such are left out.
TEST(Obj, FacesOfOneOrTwoCornersAreTrianglesWithoutArea) {
    const std::string text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2\nf 1 2 3\nusemtl a\nf 3\nf \nf #\n";
    EXPECT_THAT(parse_obj(text, "m.obj").triangles,
                ElementsAre(Triangle{0, 1, 1}, Triangle{0, 1, 2}, Triangle{2, 2, 2}));
    EXPECT_THAT(ObjFile(text, "m.obj").mesh({{"a"}, false}).triangles, ElementsAre(Triangle{0, 0, 0}));
}

/// As Microsoft's library writes it, where others write "nan".
TEST(Obj, WhatIsNoNumberIsNone) {
    for (const char *text : {"nan", "1.#INF", "-1.#IND", "1.#QNAN", "1.#SNAN"}) {
        const Mesh mesh = parse_obj(std::string("v 0 0 0\nv 1 ") + text + " 0\nv 0 1 " + text + "\nf 1 2 3\n", "m.obj");
        ASSERT_EQ(mesh.positions.size(), 3u) << text;
        EXPECT_TRUE(std::isnan(mesh.positions[1].y) && std::isnan(mesh.positions[2].z)) << text;
    }
    EXPECT_EQ(parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 2#1\nf 1 2 3\n", "m.obj").positions[2].z, 2) << "a comment";
}

TEST(Obj, Errors) {
    const std::string head = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
    EXPECT_THAT(obj_error(head + "f 1 2 4\n"), HasSubstr("m.obj:4: face index out of range: v 4 of 3"));
    EXPECT_THAT(obj_error(head + "f 1 2 0\n"), HasSubstr("m.obj:4"));
    EXPECT_THAT(obj_error(head + "f 1 2 -4\n"), HasSubstr("-4"));
    EXPECT_THAT(obj_error(head + "f 1/1 2/1 3/1\n"), HasSubstr("vt 1 of 0"));
    EXPECT_THAT(obj_error(head + "f 1//1 2//1 3//1\n"), HasSubstr("vn 1 of 0"));
    EXPECT_THAT(obj_error(head + "f a b c\n"), HasSubstr("\"a b c"));
    EXPECT_THAT(obj_error(head + "f 1,2 2 3\n"), HasSubstr("m.obj:4: a face corner"));
    EXPECT_THAT(obj_error("v 0 zero 0\n"), HasSubstr("m.obj:1: \"zero 0"));
    EXPECT_EQ(obj_error("v 0 \x1b[2Jzero\n"), "m.obj:1: \"\" is not a number");
    EXPECT_EQ(obj_error("v 0 zero\x7f 0\n"), "m.obj:1: \"zero\" is not a number");
    EXPECT_EQ(obj_error("v 0 abcdefghijklmnopqrstuvw\u00e9\n"), "m.obj:1: \"abcdefghijklmnopqrstuvw\" is not a number");
    EXPECT_EQ(obj_error("v 0 abcdefghijklmnopqrstuv\u00e9s\n"),
              "m.obj:1: \"abcdefghijklmnopqrstuv\u00e9\" is not a number");
    EXPECT_THAT(obj_error("v 0 0\n"), HasSubstr("three numbers"));
    EXPECT_THAT(obj_error(head + "f 1 2 99999999999999999999999\n"), HasSubstr("out of range"));
}

TEST(Ply, Ascii) {
    const Mesh mesh = parse_ply("ply\r\nformat ascii 1.0\r\nobj_info x\r\nelement vertex 4\r\nproperty float x\r\n"
                                "property float y\r\nproperty float z\r\nproperty float u\r\nproperty float v\r\n"
                                "element face 2\r\nproperty list uchar int vertex_index\r\nend_header\r\n"
                                "0 0 0 0 0\r\n1 0 0 1 0\r\n1 1 0 1 1\r\n0 1 1e-1 0 1\r\n4 0 1 2 3\r\n3 2 1 0\r\n",
                                "m.ply");
    EXPECT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.positions[3], (Vector3{0, 1, 0.1f}));
    EXPECT_EQ(mesh.texcoords[2], (std::array{1.0f, 1.0f}));
    EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{2, 1, 0}));
}

TEST(Ply, FacesOfFewerThanThreeCornersAreTrianglesWithoutArea) {
    const std::string text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
                             "float z\nelement face 4\nproperty list uchar int vertex_index\nend_header\n"
                             "0 0 0\n1 0 0\n0 1 0\n2 1 2\n3 0 1 2\n1 2\n0\n";
    EXPECT_THAT(parse_ply(text, "m.ply").triangles,
                ElementsAre(Triangle{1, 2, 2}, Triangle{0, 1, 2}, Triangle{2, 2, 2}, Triangle{0, 0, 0}));
}

/// Three faces as MeshLab writes them, of which the second has no coordinates.
std::string ply_with_corner_texcoords(const std::string &texcoords_of_last) {
    return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty "
           "float heat_x\nelement face 3\nproperty list uchar int vertex_indices\nproperty list uchar float "
           "texcoord\nproperty int "
           "texnumber\nend_header\n0 0 0 10\n1 0 0 11\n1 1 0 12\n0 1 0 13\n"
           "3 0 1 2 6 0 0 1 0 1 1 0\n3 1 2 3 0 0\n3 0 2 3 " +
           texcoords_of_last + " 0\n";
}

TEST(Ply, TextureCoordinatesOfCornersSplitVertices) {
    const Mesh mesh = parse_ply(ply_with_corner_texcoords("6 0 0 0.5 0.25 0 1"), "m.ply", {"vertex_heat"});
    ASSERT_EQ(mesh.triangles.size(), 3u);
    using Pair = std::array<float, 2>;
    const Pair expected[3][3] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {0, 0}, {0, 0}}, {{0, 0}, {0.5f, 0.25f}, {0, 1}}};
    const float vertices[3][3] = {{0, 1, 2}, {1, 2, 3}, {0, 2, 3}};
    ASSERT_EQ(mesh.attributes.at(0).values.size(), mesh.positions.size());
    for (int triangle = 0; triangle < 3; ++triangle)
        for (int corner = 0; corner < 3; ++corner) {
            const std::uint32_t vertex = mesh.triangles[std::size_t(triangle)][std::size_t(corner)];
            EXPECT_EQ(mesh.texcoords.at(vertex), expected[triangle][corner]) << triangle << ' ' << corner;
            EXPECT_EQ(mesh.attributes[0].values[vertex], 10 + vertices[triangle][corner]);
        }
    EXPECT_EQ(mesh.positions.size(), 1 + 2 + 3 + 2u) << "a vertex for each of its coordinates";
    EXPECT_EQ(mesh.triangles[0][0], mesh.triangles[2][0]);
    EXPECT_EQ(mesh.normal_of.at(mesh.triangles[0][1]), mesh.normal_of.at(mesh.triangles[1][0]));
    EXPECT_NE(mesh.normal_of.at(mesh.triangles[0][1]), mesh.normal_of.at(mesh.triangles[0][0]));
    for (const char *wrong : {"5 0 0 1 1 2", "4 0 0 1 1", "8 0 0 0 0 0 0 0 0"})
        EXPECT_THAT(ply_error(ply_with_corner_texcoords(wrong)), HasSubstr("a face of 3 corners has ")) << wrong;
}

TEST(Ply, BinaryOfBothByteOrders) {
    const Mesh mesh = folded_square();
    for (bool big_endian : {false, true})
        expect_same(parse_ply(binary_ply(mesh, big_endian), "m.ply"), mesh);
}

TEST(Ply, Errors) {
    const std::string binary = binary_ply(folded_square(), false);
    for (std::size_t cut = 1; cut < binary.size(); ++cut) // the last element of all is needed, too
        EXPECT_NE(ply_error(binary.substr(0, cut)), "") << cut;
    EXPECT_THAT(ply_error("plx\n"), HasSubstr("m.ply: not a PLY file"));
    EXPECT_THAT(ply_error("ply\nformat xml 1.0\nend_header\n"), HasSubstr("m.ply:2: unknown PLY format \"xml\""));
    EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement vertex -1\nend_header\n"), HasSubstr("m.ply:3"));
    EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\nend_header\n"),
                HasSubstr("m.ply:4: unknown property type"));
    EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"),
                HasSubstr("no x, y and z"));
    EXPECT_THAT(ply_error("ply\nend_header\n"), HasSubstr("no format"));
    const std::string head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
                             "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    EXPECT_THAT(ply_error(head + "0 0 0\n3 0 0 1\n"), HasSubstr("index 1 is out of range: there are 1"));
    EXPECT_THAT(ply_error(head + "0 0 0\n3 0 0 -1\n"), HasSubstr("out of range"));
    EXPECT_THAT(ply_error(head + "0 0 x\n3 0 0 0\n"), HasSubstr("\"x"));
    EXPECT_EQ(ply_error(head + "0 0 x\n3 0 0 0\n"), "m.ply: \"x\" is not a number");
    const std::string points = head.substr(0, head.find("element face"));
    EXPECT_EQ(ply_error(points + "end_header\n0 0 0\n"), "m.ply: the file has vertices but no element \"face\"");
    EXPECT_EQ(ply_error(points + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n3 0 0 "
                                 "0\n"),
              "m.ply: the file has vertices but no element \"face\"; not read: \"tristrips\"");
    const std::string faces = "element face 1\nproperty list uchar int ";
    EXPECT_EQ(ply_error(points + faces + "vind\nproperty uchar vertex_indices\nend_header\n0 0 0\n3 0 0 0 1\n"),
              "m.ply: the faces have no property list \"vertex_indices\" or \"vertex_index\"; not read: \"vind\", "
              "\"vertex_indices\"");
    EXPECT_THAT(ply_error(points + "element face 1\nend_header\n0 0 0\n"),
                HasSubstr("the faces have no property list"));
    EXPECT_EQ(ply_error(points + "element face 0\nend_header\n0 0 0\n"), "");
    EXPECT_THAT(ply_error("ply\nformat binary_little_endian 1.0\nelement vertex 1000000000000\nproperty float "
                          "x\nproperty float y\nproperty float z\nend_header\n"),
                HasSubstr("1000000000000"));
}

TEST(Serialized, BothVersionsAllPrecisionsSeveralMeshes) {
    Mesh second = folded_square();
    second.normals.clear();
    second.texcoords.clear();
    second.positions[3].z = 7;
    for (std::uint16_t version : {3, 4})
        for (std::uint32_t precision : {0u, 0x1000u, 0x2000u})
            for (bool colors : {false, true}) {
                const SerializedOptions options{version, precision, colors, colors};
                const std::string file = serialized_file({folded_square(), second, folded_square()}, options);
                expect_same(parse_serialized(file, "m", 0).mesh, folded_square());
                expect_same(parse_serialized(file, "m", 1).mesh, second);
                expect_same(parse_serialized(file, "m", 2).mesh, folded_square());
                EXPECT_EQ(parse_serialized(file, "m", 1).face_normals, colors);
                EXPECT_THAT(serialized_error(file, 3), HasSubstr("no mesh 3; the file holds 3"));
            }
}

TEST(Serialized, Errors) {
    const std::string good = serialized_file({folded_square(), folded_square()}, {});
    ASSERT_EQ(serialized_error(good, 1), "");
    EXPECT_THAT(serialized_error(""), HasSubstr("m.serialized: not a serialized mesh file"));
    EXPECT_THAT(serialized_error("PK" + good.substr(2)), HasSubstr("1C 04"));
    std::string version = good;
    version[2] = 9;
    EXPECT_THAT(serialized_error(version), HasSubstr("version 9"));
    std::string count = good;
    count[count.size() - 1] = 0x7f;
    EXPECT_THAT(serialized_error(count), HasSubstr("corrupt"));
    std::string offset = good;
    offset[offset.size() - 4 - 8 + 3] = 0x7f; // the second mesh's
    EXPECT_THAT(serialized_error(offset, 1), HasSubstr("offset of mesh 1"));
    std::string stream = good;
    stream[30] = char(stream[30] ^ 0xff);
    EXPECT_NE(serialized_error(stream, 0), "");
    EXPECT_EQ(serialized_error(stream, 1), "");
}

/// A file of one mesh whose payload was tampered with.
std::string tampered(std::size_t at, std::uint64_t value) {
    std::string payload = serialized_payload(folded_square(), {});
    std::string bytes;
    append_bytes(bytes, value);
    payload.replace(at, 8, bytes);
    std::string file("\x1c\x04\x04\x00", 4);
    file += deflated(payload);
    append_bytes<std::uint64_t>(file, 0);
    append_bytes<std::uint32_t>(file, 1);
    return file;
}

TEST(Serialized, FalseCountsAndIndices) {
    const std::size_t counts = 4 + 7; // after the flags and the name
    EXPECT_THAT(serialized_error(tampered(counts, ~0ull)), HasSubstr("claims"));
    EXPECT_THAT(serialized_error(tampered(counts, 300)), HasSubstr("truncated"));
    EXPECT_THAT(serialized_error(tampered(counts + 8, ~0ull)), HasSubstr("claims"));
    EXPECT_THAT(serialized_error(tampered(counts + 8, 300)), HasSubstr("truncated"));
    const std::size_t last = serialized_payload(folded_square(), {}).size() - 8;
    EXPECT_THAT(serialized_error(tampered(last, 4)), HasSubstr("vertex 4 of 4"));
}

} // namespace
} // namespace gradus
