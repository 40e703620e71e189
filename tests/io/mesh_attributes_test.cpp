// Numbers that meshes bear at vertices and faces: read from files, kept where textures name them.
#include "runtime/io/diagnostics.h"
#include "runtime/io/mesh_files.h"
#include "tests/io/mesh_text.h"
#include "tests/io/scene_text.h"

namespace gradus {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// A quadrilateral with these properties and, behind each vertex and the face, what they are.
std::string ascii_ply(const std::vector<std::string> &of_vertices, const std::vector<std::string> &of_face,
                      const std::vector<std::string> &vertices, const std::string &face) {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
    for (const std::string &property : of_vertices)
        text += "property " + property + "\n";
    text += "element face 1\n";
    if (!of_face.empty())
        text += "property " + of_face[0] + "\n"; // before the indices
    text += "property list uchar int vertex_indices\n";
    for (std::size_t i = 1; i < of_face.size(); ++i)
        text += "property " + of_face[i] + "\n";
    text += "end_header\n";
    const char *places[] = {"0 0 0", "1 0 0", "1 1 0", "0 1 0"};
    for (std::size_t i = 0; i < 4; ++i)
        text += std::string(places[i]) + " " + vertices[i] + "\n";
    const std::size_t space = face.find(' ');
    return text + face.substr(0, space) + " 4 0 1 2 3 " + (space == std::string::npos ? "" : face.substr(space)) + "\n";
}

const std::vector<std::string> rising = {"0 1 2", "3 4 5", "6 7 8", "9 10 11"};

Mesh vertices_of(const std::string &first, const std::string &second, const std::string &third,
                 const std::string &wanted, const std::string &type = "float ") {
    return parse_ply(ascii_ply({type + first, type + second, type + third}, {}, rising, ""), "m.ply", {wanted});
}

TEST(MeshAttributes, HaveMitsubasNames) {
    const std::vector<std::vector<std::string>> known = {{"r", "g", "b", "vertex_color"},
                                                         {"red", "green", "blue", "vertex_color"},
                                                         {"heat_x", "heat_y", "heat_z", "vertex_heat"},
                                                         {"heat_0", "heat_1", "heat_2", "vertex_heat"},
                                                         {"heat_1", "heat_2", "heat_3", "vertex_heat"},
                                                         {"heat_r", "heat_g", "heat_b", "vertex_heat_color"}};
    for (const auto &names : known) {
        const Mesh mesh = vertices_of(names[0], names[1], names[2], names[3]);
        ASSERT_THAT(mesh.attributes, SizeIs(1)) << names[0];
        EXPECT_EQ(mesh.attributes[0].name, names[3]);
        EXPECT_EQ(mesh.attributes[0].channels, 3u);
        EXPECT_THAT(mesh.attributes[0].values, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11));
    }
    EXPECT_THAT(vertices_of("r", "g", "b", "vertex_heat").attributes, IsEmpty()) << "another is asked for";
    EXPECT_THAT(vertices_of("r", "g", "b", "face_color").attributes, IsEmpty());
    const Mesh one = vertices_of("heat_x", "a", "b", "vertex_heat");
    EXPECT_EQ(one.attributes.at(0).channels, 1u);
    EXPECT_THAT(one.attributes.at(0).values, ElementsAre(0, 3, 6, 9));
    // Bytes of colours are of 255, other whole numbers are what they are.
    EXPECT_FLOAT_EQ(vertices_of("r", "g", "b", "vertex_color", "uchar ").attributes.at(0).values[11], 11 / 255.0f);
    EXPECT_FLOAT_EQ(vertices_of("a_x", "a_y", "a_z", "vertex_a", "uchar ").attributes.at(0).values[11], 11);
}

TEST(MeshAttributes, OfAFaceAreThoseOfItsTriangles) {
    const std::string text = ascii_ply({}, {"float r", "float g", "float b"}, {"", "", "", ""}, "0.5 0.25 0.75");
    const Mesh mesh = parse_ply(text, "m.ply", {"face_color"});
    EXPECT_THAT(mesh.triangles, SizeIs(2));
    EXPECT_THAT(mesh.attributes.at(0).values, ElementsAre(0.5f, 0.25f, 0.75f, 0.5f, 0.25f, 0.75f));
}

TEST(MeshAttributes, OfBinaryFiles) {
    for (const bool big_endian : {false, true}) {
        std::string file =
            "ply\nformat binary_" + std::string(big_endian ? "big" : "little") +
            "_endian 1.0\nelement vertex 3\nproperty uchar green\nproperty float x\nproperty float "
            "y\nproperty uchar red\nproperty float z\nproperty uchar blue\nelement face 1\nproperty list "
            "uchar int vertex_indices\nproperty float w_x\nend_header\n";
        for (int i = 0; i < 3; ++i) {
            append_bytes<std::uint8_t>(file, std::uint8_t(50 + i));
            append_bytes<float>(file, i == 1, big_endian);
            append_bytes<float>(file, i == 2, big_endian);
            append_bytes<std::uint8_t>(file, std::uint8_t(100 + i));
            append_bytes<float>(file, 0, big_endian);
            append_bytes<std::uint8_t>(file, std::uint8_t(200 + i));
        }
        append_bytes<std::uint8_t>(file, 3);
        for (int i = 0; i < 3; ++i)
            append_bytes<std::int32_t>(file, i, big_endian);
        append_bytes<float>(file, 0.5f, big_endian);
        const Mesh mesh = parse_ply(file, "m.ply", {"face_w", "vertex_color"});
        ASSERT_THAT(mesh.attributes, SizeIs(2));
        EXPECT_THAT(mesh.attributes[0].values,
                    ElementsAre(100 / 255.0f, 50 / 255.0f, 200 / 255.0f, 101 / 255.0f, 51 / 255.0f, 201 / 255.0f,
                                102 / 255.0f, 52 / 255.0f, 202 / 255.0f));
        EXPECT_THAT(mesh.attributes[1].values, ElementsAre(0.5f));
        for (std::size_t size = file.find("end_header"); size < file.size(); ++size)
            EXPECT_THROW(parse_ply(file.substr(0, size), "m.ply", {"face_w", "vertex_color"}), SceneError);
    }
}

TEST(MeshAttributes, OfOddFilesAreErrors) {
    const auto error = [](const std::vector<std::string> &vertex, const std::vector<std::string> &face,
                          const std::vector<std::string> &values, const std::string &wanted) {
        try {
            parse_ply(ascii_ply(vertex, face, values, ""), "m.ply", {wanted});
        } catch (const SceneError &caught) {
            return std::string(caught.what());
        }
        return std::string();
    };
    EXPECT_THAT(
        error({"float heat_x", "float heat_y"}, {}, {"1 2", "1 2", "1 2", "1 2"}, "vertex_heat"),
        HasSubstr("m.ply: the attribute \"vertex_heat\" has two numbers, \"heat_x\" and \"heat_y\"; it needs one or "
                  "three"));
    EXPECT_EQ(error({"float heat_x", "float heat_y"}, {}, {"1 2", "1 2", "1 2", "1 2"}, "vertex_color"), "");
    const std::vector<std::string> lists(4, "1 2 1 1 1 1");
    EXPECT_THAT(error({"list uchar float r", "list uchar float g", "list uchar float b"}, {}, lists, "vertex_color"),
                HasSubstr("the property \"r\" of \"vertex_color\" is a list where a number is expected"));
    EXPECT_EQ(error({"list uchar float r", "list uchar float g", "list uchar float b"}, {}, lists, "vertex_heat"), "");
    EXPECT_THAT(error({"float r", "float g", "float b"}, {}, {"1 2 3", "1 2 x", "1 2 3", "1 2 3"}, "vertex_color"),
                HasSubstr("is not a number"));
}

TEST(MeshAttributes, OfSerializedFilesAreTheirColours) {
    for (const std::uint16_t version : {std::uint16_t(3), std::uint16_t(4)}) {
        SerializedOptions options;
        options.version = version;
        options.colors = true;
        const std::string file = serialized_file({folded_square()}, options);
        const Mesh mesh = parse_serialized(file, "m", 0, {}, {"vertex_color"}).mesh;
        EXPECT_THAT(mesh.attributes.at(0).values, testing::AllOf(SizeIs(12), testing::Each(0.5f)));
        EXPECT_THAT(parse_serialized(file, "m", 0).mesh.attributes, IsEmpty());
        options.colors = false;
        EXPECT_THAT(
            parse_serialized(serialized_file({folded_square()}, options), "m", 0, {}, {"vertex_color"}).mesh.attributes,
            IsEmpty());
    }
}

class SceneWithAttributes : public ::testing::Test {
  protected:
    SceneWithAttributes() {
        folder_.write("c.ply", ascii_ply({"uchar red", "uchar green", "uchar blue"}, {},
                                         {"255 0 0", "0 255 0", "0 0 255", "128 128 128"}, ""));
        folder_.write("plain.ply", ascii_ply({}, {}, {"", "", "", ""}, ""));
    }
    static std::string shape(const std::string &file, const std::string &texture, const std::string &rest = "") {
        return "<shape type=\"ply\"><string name=\"filename\" value=\"" + file + "\"/>" + rest +
               "<bsdf type=\"diffuse\"><texture name=\"reflectance\" " + texture + "</bsdf></shape>";
    }
    LoadedScene load(const std::string &shapes, const std::string &version = "3.0.0") {
        return load_scene(folder_.write("scene.xml", text_of(shapes, version)));
    }
    std::string error(const std::string &shapes) {
        return error_of(folder_.write("scene.xml", text_of(shapes, "3.0.0")));
    }
    static std::string text_of(const std::string &shapes, const std::string &version) {
        return scene_around(shapes + "<emitter type=\"constant\"/>", version, "");
    }
    const std::string of_mesh_ = "type=\"mesh_attribute\"><string name=\"name\" value=\"vertex_color\"/></texture>";
    TemporaryFolder folder_;
};

/// As newer programs write textures of one colour, and take any.
TEST_F(SceneWithAttributes, KeepsWhatSpectraName) {
    std::string text = shape("c.ply", of_mesh_);
    for (const std::string tag : {"<texture", "</texture"})
        text.replace(text.find(tag), tag.size(), tag[1] == '/' ? "</spectrum" : "<spectrum");
    const LoadedScene loaded = load(text);
    EXPECT_EQ(loaded.scene.textures.at(0).attribute, "vertex_color");
    EXPECT_FLOAT_EQ(loaded.scene.meshes.at(0).attributes.at(0).values[9], 128 / 255.0f);
}

TEST_F(SceneWithAttributes, KeepsWhatTexturesName) {
    const LoadedScene loaded = load(shape("c.ply", of_mesh_) + shape("plain.ply", "type=\"checkerboard\"/>"));
    EXPECT_THAT(loaded.warnings, IsEmpty());
    const Texture &texture = loaded.scene.textures.at(0);
    EXPECT_EQ(texture.kind, Texture::Kind::mesh_attribute);
    EXPECT_EQ(texture.attribute, "vertex_color");
    EXPECT_EQ(texture.scale[0], 1);
    EXPECT_FLOAT_EQ(loaded.scene.meshes.at(0).attributes.at(0).values[9], 128 / 255.0f);
    EXPECT_THAT(loaded.scene.meshes.at(1).attributes, IsEmpty());
    EXPECT_THAT(load(shape("c.ply", "type=\"checkerboard\"/>")).scene.meshes.at(0).attributes, IsEmpty());
    const std::string scaled =
        "type=\"mesh_attribute\"><string name=\"name\" value=\"vertex_color\"/><float name=\"scale\" value=\"0.25\"/>"
        "</texture>";
    EXPECT_EQ(load(shape("c.ply", scaled)).scene.textures.at(0).scale[1], 0.25f);
}

TEST_F(SceneWithAttributes, OfTheOldDialect) {
    const LoadedScene loaded = load(shape("c.ply", "type=\"vertexcolors\"/>"), "0.6.0");
    EXPECT_THAT(loaded.warnings, IsEmpty());
    EXPECT_EQ(loaded.scene.textures.at(0).attribute, "vertex_color");
    // Colours are taken as sRGB there unless the shape says otherwise.
    EXPECT_NEAR(loaded.scene.meshes.at(0).attributes.at(0).values[9], srgb_to_linear_value(128 / 255.0), 1e-6);
    const LoadedScene linear =
        load(shape("c.ply", "type=\"vertexcolors\"/>", "<boolean name=\"srgb\" value=\"false\"/>"), "0.6.0");
    EXPECT_FLOAT_EQ(linear.scene.meshes.at(0).attributes.at(0).values[9], 128 / 255.0f);
}

TEST_F(SceneWithAttributes, InstancesAndMergesKeepThem) {
    const std::string placed = "<transform name=\"to_world\"><scale x=\"-1\"/></transform>";
    const LoadedScene loaded = load("<shape type=\"shapegroup\" id=\"g\">" + shape("c.ply", of_mesh_) +
                                    "</shape><shape type=\"instance\"><ref id=\"g\"/>" + placed +
                                    "</shape><shape type=\"merge\">" + shape("c.ply", of_mesh_) + "</shape>");
    ASSERT_THAT(loaded.scene.meshes, SizeIs(2));
    for (const Mesh &mesh : loaded.scene.meshes)
        EXPECT_EQ(mesh.attributes.at(0).values, loaded.scene.meshes[0].attributes.at(0).values);
}

TEST_F(SceneWithAttributes, FacesOfNoAreaTakeTheirNumbersAlong) {
    folder_.write("f.ply",
                  "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
                  "z\nelement face 3\nproperty list uchar int vertex_indices\nproperty float a_0\nproperty "
                  "float a_1\nproperty float a_2\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 1 2 3\n3 0 0 1 "
                  "4 5 6\n3 0 2 3 7 8 9\n");
    const LoadedScene loaded =
        load(shape("f.ply", "type=\"mesh_attribute\"><string name=\"name\" value=\"face_a\"/></texture>"));
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("1 degenerate")));
    EXPECT_THAT(loaded.scene.meshes.at(0).attributes.at(0).values, ElementsAre(1, 2, 3, 7, 8, 9));
}

TEST_F(SceneWithAttributes, NumbersThatAreNoneBecomeZero) {
    folder_.write("n.ply",
                  ascii_ply({"float r", "float g", "float b"}, {}, {"nan 1 1", "1 inf 1", "1 1 1", "1 1 1"}, ""));
    const LoadedScene loaded = load(shape("n.ply", of_mesh_));
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("2 values of attributes that are no finite numbers become 0")));
    EXPECT_THAT(loaded.scene.meshes.at(0).attributes.at(0).values, ElementsAre(0, 1, 1, 1, 0, 1, 1, 1, 1, 1, 1, 1));
}

TEST_F(SceneWithAttributes, MissingOnesAreErrors) {
    EXPECT_THAT(error("\n" + shape("plain.ply", of_mesh_)),
                testing::AllOf(HasSubstr("scene.xml:4"), HasSubstr("has no attribute \"vertex_color\"")));
    EXPECT_THAT(error("<shape type=\"sphere\"><bsdf type=\"diffuse\"><texture name=\"reflectance\" " + of_mesh_ +
                      "</bsdf></shape>"),
                HasSubstr("has no attribute \"vertex_color\""));
    EXPECT_THAT(error(shape("c.ply", "type=\"mesh_attribute\"/>")), HasSubstr("mesh_attribute needs a name"));
    EXPECT_THAT(error(shape("c.ply", "type=\"mesh_attribute\"><string name=\"name\" value=\"color\"/></texture>")),
                HasSubstr("begins with vertex_ or face_"));
}

} // namespace
} // namespace gradus
