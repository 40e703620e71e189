// Shapes as a scene file asks for them.
#include "runtime/scene/mesh_builder.h"
#include "runtime/scene/transform.h"
#include "tests/io/mesh_text.h"
#include "tests/io/scene_text.h"

#include <cmath>

namespace gradus {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Scene scene_of(const std::string &shape, const std::string &version = "3.0.0") {
    return load_text(scene_around(shape, version, "")).scene;
}

/// Sum over triangles of (p0 x p1) . p2 / 6: positive where the front is outside.
double signed_volume(const Mesh &mesh) {
    double volume = 0;
    for (const auto &t : mesh.triangles)
        volume += dot(cross(to_double(mesh.positions[t[0]]), to_double(mesh.positions[t[1]])),
                      to_double(mesh.positions[t[2]])) /
                  6;
    return volume;
}

Double3 normal_of_first(const Mesh &mesh) {
    const auto &t = mesh.triangles.at(0);
    const Double3 p0 = to_double(mesh.positions[t[0]]);
    return normalize(
        cross(subtract(to_double(mesh.positions[t[1]]), p0), subtract(to_double(mesh.positions[t[2]]), p0)));
}

TEST(Rectangle, SizeSideAndTexcoords) {
    const Mesh mesh = scene_of("<shape type=\"rectangle\"/>").meshes.at(0);
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_NEAR(surface_area(mesh), 4, 1e-6);
    EXPECT_NEAR(normal_of_first(mesh)[2], 1, 1e-12);
    EXPECT_TRUE(mesh.normals.empty());
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_FLOAT_EQ(mesh.texcoords[i][0], (mesh.positions[i].x + 1) / 2);
        EXPECT_FLOAT_EQ(mesh.texcoords[i][1], (mesh.positions[i].y + 1) / 2);
    }
}

TEST(Rectangle, MirroredKeepsItsSideAndFlippedTurnsIt) {
    const auto with = [](const std::string &inside) {
        return normal_of_first(scene_of("<shape type=\"rectangle\">" + inside + "</shape>").meshes.at(0))[2];
    };
    const std::string mirror = "<transform name=\"to_world\"><scale x=\"-1\"/></transform>";
    const std::string flip = "<boolean name=\"flip_normals\" value=\"true\"/>";
    EXPECT_GT(with(mirror), 0);
    EXPECT_LT(with(flip), 0);
    EXPECT_LT(with(mirror + flip), 0);
    EXPECT_LT(with("<transform name=\"to_world\"><scale z=\"-1\"/></transform>"), 0);
}

TEST(Rectangle, SlightShearIsFine) {
    const Mesh mesh = scene_of("<shape type=\"rectangle\"><transform name=\"to_world\"><matrix value=\"1 0.2 0 0 1 0 0 "
                               "0 1\"/></transform></shape>")
                          .meshes.at(0);
    EXPECT_NEAR(surface_area(mesh), 4, 1e-6);
}

TEST(Cube, IsClosedWithItsFrontOutside) {
    const Mesh mesh = scene_of("<shape type=\"cube\"/>").meshes.at(0);
    EXPECT_EQ(mesh.triangles.size(), 12u);
    EXPECT_EQ(mesh.positions.size(), 24u);
    EXPECT_NEAR(surface_area(mesh), 24, 1e-5);
    EXPECT_NEAR(signed_volume(mesh), 8, 1e-5);
    const Mesh mirrored =
        scene_of("<shape type=\"cube\"><transform name=\"to_world\"><scale y=\"-2\"/></transform></shape>")
            .meshes.at(0);
    EXPECT_NEAR(signed_volume(mirrored), 16, 1e-5);
    const Mesh inside_out =
        scene_of("<shape type=\"cube\"><boolean name=\"flipNormals\" value=\"true\"/></shape>", "0.6.0").meshes.at(0);
    EXPECT_NEAR(signed_volume(inside_out), -8, 1e-5);
}

TEST(Sphere, CenterRadiusAndTransform) {
    const Sphere plain = scene_of("<shape type=\"sphere\"/>").spheres.at(0);
    expect_vector(plain.center, 0, 0, 0);
    EXPECT_FLOAT_EQ(plain.radius, 1);
    EXPECT_FALSE(plain.flip_normals);
    const Sphere moved =
        scene_of("<shape type=\"sphere\"><point name=\"center\" x=\"1\"/><float name=\"radius\" value=\"3\"/>"
                 "<transform name=\"to_world\"><rotate z=\"1\" angle=\"90\"/><scale value=\"2\"/><translate x=\"1\" "
                 "y=\"2\" z=\"3\"/></transform></shape>")
            .spheres.at(0);
    expect_vector(moved.center, 1, 4, 3);
    EXPECT_FLOAT_EQ(moved.radius, 6);
}

TEST(Sphere, MirrorsTurnItInsideOutAsInMitsuba3) {
    const std::string mirror = "<transform name=\"to_world\"><scale x=\"-1\"/></transform>";
    EXPECT_TRUE(scene_of("<shape type=\"sphere\">" + mirror + "</shape>").spheres.at(0).flip_normals);
    EXPECT_FALSE(
        scene_of("<shape type=\"sphere\">" + mirror + "<boolean name=\"flip_normals\" value=\"true\"/></shape>")
            .spheres.at(0)
            .flip_normals);
    EXPECT_FALSE(
        scene_of("<shape type=\"sphere\"><transform name=\"toWorld\"><scale x=\"-1\"/></transform></shape>", "0.6.0")
            .spheres.at(0)
            .flip_normals);
}

std::string with_matrix(const char *matrix) {
    return std::string("<transform name=\"to_world\">") + matrix + "</transform>";
}

TEST(Disk, AreaSideAndTexcoords) {
    const Mesh mesh = scene_of("<shape type=\"disk\"/>").meshes.at(0);
    EXPECT_NEAR(surface_area(mesh), 3.14159265, 1e-6);
    EXPECT_NEAR(normal_of_first(mesh)[2], 1, 1e-12);
    EXPECT_TRUE(mesh.normals.empty());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) { // radius and angle
        const double radius = std::hypot(mesh.positions[i].x, mesh.positions[i].y);
        EXPECT_NEAR(mesh.texcoords[i][0], radius, 6e-5);
        if (radius > 0.5 && mesh.texcoords[i][1] < 1) {
            const double angle = std::atan2(mesh.positions[i].y, mesh.positions[i].x) / (2 * 3.14159265358979);
            EXPECT_NEAR(mesh.texcoords[i][1], angle < -1e-6 ? angle + 1 : angle, 1e-6);
        }
    }
}

TEST(Disk, MirroredAsNormalsAreAndFlippedTurned) {
    const auto with = [](const std::string &inside) {
        return normal_of_first(scene_of("<shape type=\"disk\">" + inside + "</shape>").meshes.at(0))[2];
    };
    EXPECT_GT(with(with_matrix("<scale x=\"-1\"/>")), 0);
    EXPECT_LT(with(with_matrix("<scale z=\"-1\"/>")), 0);
    EXPECT_LT(with("<boolean name=\"flipNormals\" value=\"true\"/>"), 0);
}

TEST(Cylinder, AreaNormalsAndTexcoords) {
    const Mesh mesh = scene_of("<shape type=\"cylinder\"><point name=\"p0\" value=\"1 2 3\"/><point name=\"p1\" "
                               "value=\"1 4 3\"/><float name=\"radius\" value=\"0.5\"/></shape>")
                          .meshes.at(0);
    EXPECT_NEAR(surface_area(mesh), 2 * 3.14159265 * 0.5 * 2, 1e-5);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Double3 out = {mesh.positions[i].x - 1.0, 0, mesh.positions[i].z - 3.0};
        EXPECT_NEAR(length(out), 0.5, 5e-5);
        EXPECT_NEAR(dot(normalize(out), to_double(mesh.normals[i])), 1, 1e-6);
        EXPECT_FLOAT_EQ(mesh.positions[i].y, 2 + 2 * mesh.texcoords[i][1]);
    }
    for (const auto &t : mesh.triangles) { // wound as the normals point
        const Double3 p0 = to_double(mesh.positions[t[0]]);
        const Double3 area =
            cross(subtract(to_double(mesh.positions[t[1]]), p0), subtract(to_double(mesh.positions[t[2]]), p0));
        EXPECT_GT(dot(area, to_double(mesh.normals[t[0]])), 0);
    }
}

TEST(Cylinder, AnglesAndSidesAreMitsubas) {
    // Found by tracing rays in Mitsuba 3.9: at angle u around +z from +x; outside is the front, mirrored or not.
    const auto front = [](const std::string &inside) {
        const Mesh mesh = scene_of("<shape type=\"cylinder\">" + inside + "</shape>").meshes.at(0);
        const Double3 n = normal_of_first(mesh), p = to_double(mesh.positions[mesh.triangles[0][0]]);
        return n[0] * p[0] + n[1] * p[1];
    };
    const Mesh mesh = scene_of("<shape type=\"cylinder\"/>").meshes.at(0);
    expect_vector(mesh.normals[2 * 64], 0, 1, 0);
    EXPECT_FLOAT_EQ(mesh.texcoords[2 * 64][0], 0.25f);
    EXPECT_GT(front(""), 0);
    EXPECT_GT(front(with_matrix("<scale x=\"-1\"/>")), 0);
    EXPECT_GT(front(with_matrix("<scale z=\"-1\"/>")), 0);
    EXPECT_GT(front("<float name=\"radius\" value=\"-1\"/>"), 0);
    EXPECT_LT(front("<boolean name=\"flip_normals\" value=\"true\"/>"), 0);
}

TEST(Merge, ShapesStandAsByThemselves) {
    const Scene scene =
        scene_of("<shape type=\"merge\"><shape type=\"cube\"/><shape type=\"merge\"><shape "
                 "type=\"sphere\"/><ref id=\"r\"/></shape></shape><shape type=\"rectangle\" id=\"r\"/>");
    ASSERT_EQ(scene.shapes.size(), 4u);
    EXPECT_EQ(scene.shapes[0].kind, Shape::Kind::mesh);
    EXPECT_EQ(scene.shapes[1].kind, Shape::Kind::sphere);
    EXPECT_EQ(scene.meshes[scene.shapes[2].geometry].triangles.size(), 2u);
    EXPECT_EQ(scene.meshes[scene.shapes[3].geometry].triangles.size(), 2u);
}

const char *const group = "<shape type=\"shapegroup\" id=\"g\"><shape type=\"cube\"><transform name=\"to_world\">"
                          "<translate x=\"3\"/></transform><bsdf type=\"conductor\"/></shape><shape type=\"sphere\">"
                          "<emitter type=\"area\"/></shape></shape>";

TEST(Instance, AreCopiesWithMaterialsAndLights) {
    const Scene scene = scene_of(std::string("<shape type=\"instance\"><transform name=\"to_world\"><scale "
                                             "value=\"2\"/><translate y=\"1\"/></transform><ref id=\"g\"/></shape>") +
                                 group + "<shape type=\"instance\"><ref id=\"g\"/></shape>");
    ASSERT_EQ(scene.shapes.size(), 4u);
    EXPECT_EQ(scene.copied_instances, 2u);
    EXPECT_EQ(scene.emitters.size(), 2u);
    const Mesh &mesh = scene.meshes.at(0);
    EXPECT_NEAR(signed_volume(mesh), 64, 1e-4);
    Vector3 low = mesh.positions[0];
    for (const Vector3 &p : mesh.positions)
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    expect_vector(low, 4, -1, -2);
    EXPECT_FLOAT_EQ(scene.spheres.at(0).radius, 2);
    expect_vector(scene.spheres.at(0).center, 0, 1, 0);
    EXPECT_FLOAT_EQ(scene.spheres.at(1).radius, 1);
    EXPECT_EQ(scene.shapes[0].material, scene.shapes[2].material);
    EXPECT_EQ(scene.materials[scene.shapes[0].material].front.kind, BsdfKind::conductor);
}

TEST(Instance, AMirrorTurnsNoFrontAsInMitsuba) {
    const Scene scene = scene_of(std::string("<shape type=\"instance\">") + with_matrix("<scale x=\"-1\"/>") +
                                 "<ref id=\"g\"/></shape>" + group);
    EXPECT_NEAR(signed_volume(scene.meshes.at(0)), 8, 1e-5);
    EXPECT_FALSE(scene.spheres.at(0).flip_normals);
}

TEST(Instance, AGroupWithoutOneIsNotSeen) {
    EXPECT_EQ(scene_of(std::string(group) + "<shape type=\"rectangle\"/>").shapes.size(), 1u);
}

/// A scene that loads a mesh file with these further parameters.
Mesh load_mesh(const std::string &type, const std::string &bytes, const std::string &parameters = "",
               const std::string &version = "3.0.0") {
    TemporaryFolder folder;
    folder.write("mesh.bin", bytes);
    return load_scene(folder.write("scene.xml", scene_around("<shape type=\"" + type +
                                                                 "\"><string name=\"filename\" value=\"mesh.bin\"/>" +
                                                                 parameters + "</shape>",
                                                             version, "")))
        .scene.meshes.at(0);
}

const std::string obj_without_normals =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nvt 0 0.25\nf 1/1 2/1 3/1\nf 1/1 3/1 4/1\n";
const std::string face_normals = "<boolean name=\"face_normals\" value=\"true\"/>";

TEST(ObjShape, NormalsAreComputedUnlessFaceNormals) {
    EXPECT_EQ(load_mesh("obj", obj_without_normals).normals.size(), 4u);
    EXPECT_TRUE(load_mesh("obj", obj_without_normals, face_normals).normals.empty());
    EXPECT_TRUE(load_mesh("obj", obj_without_normals, "<boolean name=\"faceNormals\" value=\"true\"/>", "0.5.0")
                    .normals.empty());
}

TEST(ObjShape, TexcoordsCountFromTheTopUnlessTold) {
    EXPECT_FLOAT_EQ(load_mesh("obj", obj_without_normals).texcoords[0][1], 0.75f);
    EXPECT_FLOAT_EQ(
        load_mesh("obj", obj_without_normals, "<boolean name=\"flip_tex_coords\" value=\"false\"/>").texcoords[0][1],
        0.25f);
}

TEST(ObjShape, SmoothingByAnglesIsWarnedOf) {
    TemporaryFolder folder;
    folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const LoadedScene loaded = load_scene(folder.write(
        "scene.xml", scene_around("<shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/><bsdf "
                                  "type=\"diffuse\"/><float name=\"maxSmoothAngle\" value=\"30\"/></shape><emitter "
                                  "type=\"constant\"/>",
                                  "0.6.0")));
    EXPECT_THAT(loaded.warnings, testing::ElementsAre(testing::HasSubstr("not supported: normals stay")));
}

TEST(PlyShape, TransformedWithItsNormals) {
    const Mesh mesh = load_mesh("ply", binary_ply(folded_square(), false),
                                "<transform name=\"to_world\"><rotate z=\"1\" angle=\"90\"/><translate z=\"2\"/>"
                                "</transform>");
    expect_vector(mesh.positions[1], 0, 1, 2);
    expect_vector(mesh.normals[1], -0.6, 0, 0.8);
    EXPECT_FLOAT_EQ(mesh.texcoords[1][1], 0.25f);
}

TEST(SerializedShape, IndexInBothDialects) {
    Mesh second = folded_square();
    second.positions[1].x = 3;
    const std::string file = serialized_file({folded_square(), second}, {});
    EXPECT_FLOAT_EQ(load_mesh("serialized", file).positions[1].x, 1);
    EXPECT_FLOAT_EQ(load_mesh("serialized", file, "<integer name=\"shape_index\" value=\"1\"/>").positions[1].x, 3);
    EXPECT_FLOAT_EQ(load_mesh("serialized", file, "<integer name=\"shapeIndex\" value=\"1\"/>", "0.6.0").positions[1].x,
                    3);
}

TEST(SerializedShape, FlatShadingFlagCountsInTheOldDialect) {
    SerializedOptions options;
    options.face_normals = true;
    const std::string file = serialized_file({folded_square()}, options);
    EXPECT_TRUE(load_mesh("serialized", file, "", "0.6.0").normals.empty());
    EXPECT_FALSE(load_mesh("serialized", file).normals.empty());
}

TEST(MeshShape, BrokenFilesNameThemselves) {
    TemporaryFolder folder;
    folder.write("bad.obj", "v 0 0 0\nf 1 2 3\n");
    const std::string message = error_of(folder.write(
        "scene.xml",
        scene_around("<shape type=\"obj\"><string name=\"filename\" value=\"bad.obj\"/></shape>", "3.0.0", "")));
    EXPECT_THAT(message, HasSubstr("bad.obj:2: face index out of range"));
}

TEST(MeshShape, DegenerateTrianglesAreCounted) {
    TemporaryFolder folder;
    folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n");
    const LoadedScene loaded = load_scene(folder.write(
        "scene.xml", scene_around("<shape type=\"obj\" id=\"m\"><string name=\"filename\" value=\"m.obj\"/></shape>"
                                  "<emitter type=\"constant\"/>",
                                  "3.0.0", "")));
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("1 degenerate triangles of shape \"m\"")));
    EXPECT_EQ(loaded.scene.meshes[0].triangles.size(), 1u);
}

} // namespace
} // namespace gradus
