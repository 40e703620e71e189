// Which instances of a scene file become copies, and which are kept.
#include "runtime/scene/instances.h"
#include "tests/io/scene_text.h"

#include <fmt/format.h>

namespace gradus {
namespace {

using ::testing::HasSubstr;

std::string group_of(const std::string &shapes, const std::string &id = "g") {
    return "<shape type=\"shapegroup\" id=\"" + id + "\">" + shapes + "</shape>\n";
}

std::string instance_of(const std::string &transform, const std::string &id = "g") {
    return "<shape type=\"instance\"><ref id=\"" + id + "\"/><transform name=\"to_world\">" + transform +
           "</transform></shape>\n";
}

Scene loaded_as(const std::string &body, InstanceChoice choice, std::uint64_t most_copied_bytes = 0,
                const std::string &version = "3.0.0") {
    LoadOptions options;
    options.instances = choice;
    options.most_copied_bytes = most_copied_bytes;
    return load_text(scene_around(body, version, ""), options).scene;
}

const std::string two_cubes = group_of("<shape type=\"cube\"/>") + instance_of("<translate x=\"1\"/>") +
                              instance_of("<scale x=\"-1\" y=\"2\" z=\"1\"/>");

TEST(KeptInstances, ShareTheirShapes) {
    const Scene scene = loaded_as(two_cubes, InstanceChoice::kept);
    ASSERT_EQ(scene.instances.size(), 2u);
    ASSERT_EQ(scene.shapes.size(), 1u);
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.shapes[0].group, 0);
    EXPECT_EQ(scene.groups, 1u);
    EXPECT_EQ(scene.instances[0].to_world[3], 1);
    EXPECT_EQ(scene.instances[1].to_world[5], 2);
    EXPECT_LT(determinant(matrix_of(scene.instances[1])), 0);
}

TEST(KeptInstances, AreTheSameInFilesOfVersion0) {
    std::string old = two_cubes;
    for (std::size_t at; (at = old.find("to_world")) != std::string::npos;)
        old.replace(at, 8, "toWorld");
    const Scene scene = loaded_as(old, InstanceChoice::kept, 0, "0.6.0");
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.instances[0].to_world, loaded_as(two_cubes, InstanceChoice::kept).instances[0].to_world);
}

TEST(KeptInstances, LieWhereCopiesDo) {
    const Bounds kept = world_bounds(loaded_as(two_cubes, InstanceChoice::kept));
    const Bounds copies = world_bounds(loaded_as(two_cubes, InstanceChoice::copies));
    EXPECT_EQ(kept.lower, copies.lower);
    EXPECT_EQ(kept.upper, copies.upper);
}

TEST(KeptInstances, AreThoseWhoseCopiesWouldBeLarge) {
    EXPECT_EQ(loaded_as(two_cubes, InstanceChoice::automatic, 1u << 20).instances.size(), 0u);
    const Scene kept = loaded_as(two_cubes, InstanceChoice::automatic, 100);
    EXPECT_EQ(kept.instances.size(), 2u) << "the first, which was a copy, too";
    EXPECT_EQ(kept.copied_instances, 0u);
    EXPECT_EQ(kept.shapes.size(), 1u);
    EXPECT_EQ(kept.meshes.size(), 1u);
    const Scene one = loaded_as(group_of("<shape type=\"cube\"/>") + instance_of(""), InstanceChoice::automatic, 0);
    EXPECT_EQ(one.instances.size(), 0u) << "there is nothing to share";
}

/// Corners of all meshes and centers of all spheres, where they are seen.
std::vector<Double3> places_in(const Scene &scene) {
    std::vector<Double3> places;
    const auto add_mesh = [&](const Shape &shape, const Matrix4 &to_world) {
        for (const Vector3 &position : scene.meshes.at(shape.geometry).positions)
            places.push_back(transform_point(to_world, to_double(position)));
    };
    for (const Instance &instance : scene.instances)
        for (const Shape &shape : scene.shapes)
            if (shape.group == std::int32_t(instance.group))
                add_mesh(shape, matrix_of(instance));
    for (const Shape &shape : scene.shapes)
        if (shape.kind == Shape::Kind::mesh && shape.group == no_group)
            add_mesh(shape, Matrix4());
    for (const Sphere &sphere : scene.spheres)
        places.push_back(to_double(sphere.center));
    return places;
}

// At 1e5 floats are 0.008 apart, which none of these is moved by.
TEST(Instances, AreSeenWhereTheyAreHoweverFarInTheirGroup) {
    const auto scene_at = [](double to, InstanceChoice choice) {
        const auto shape = [&](const char *type, const char *scale, const char *x) {
            return fmt::format("<shape type=\"{}\"><transform name=\"to_world\"><scale value=\"{}\"/><translate "
                               "x=\"{}\"/><translate x=\"{}\" z=\"{}\"/></transform></shape>",
                               type, scale, x, to, to);
        };
        const std::string cylinder =
            fmt::format("<shape type=\"cylinder\"><point name=\"p0\" x=\"{}\" y=\"0.1\" z=\"{}\"/><point name=\"p1\" "
                        "x=\"{}\" y=\"0.3\" z=\"{}\"/><float name=\"radius\" value=\"0.1\"/></shape>",
                        to, to, to, to);
        const std::string moved_back = fmt::format("<translate x=\"{}\" z=\"{}\"/>", -to, -to);
        return loaded_as(group_of(shape("cube", "0.3", "0.123") + shape("rectangle", "0.01", "-1.0457") +
                                  shape("sphere", "0.2", "0.7771") + cylinder) +
                             instance_of(moved_back) +
                             instance_of(moved_back + "<rotate y=\"1\" angle=\"30\"/><translate y=\"1\"/>"),
                         choice);
    };
    for (const InstanceChoice choice : {InstanceChoice::kept, InstanceChoice::copies, InstanceChoice::automatic}) {
        const std::vector<Double3> near = places_in(scene_at(0, choice));
        const Scene scene = scene_at(1e5, choice);
        const std::vector<Double3> far = places_in(scene);
        EXPECT_EQ(scene.instances.size(), choice == InstanceChoice::copies ? 0u : 2u);
        for (const Bounds &bounds : group_bounds(scene)) // rounding goes with its coordinates
            EXPECT_LT(std::max(std::fabs(bounds.lower[0]), std::fabs(bounds.upper[0])), 2);
        ASSERT_EQ(far.size(), near.size());
        for (std::size_t i = 0; i < near.size(); ++i)
            EXPECT_LT(length(subtract(far[i], near[i])), 1e-6) << i; // some roundings of what is two large
    }
}

// What is far from its own origin but in a group around that stays where it is, but for the last bit.
TEST(Instances, OfGroupsThatAreWideKeepTheirOrigin) {
    const Scene scene = loaded_as(group_of("<shape type=\"cube\"/><shape type=\"rectangle\"><transform "
                                           "name=\"to_world\"><translate x=\"100\"/></transform></shape>") +
                                      instance_of("<translate x=\"3\"/>"),
                                  InstanceChoice::kept);
    EXPECT_EQ(scene.instances.at(0).to_world[3], 3);
    const Bounds bounds = group_bounds(scene).at(0);
    EXPECT_EQ(bounds.lower, (Double3{-1, -1, -1}));
    EXPECT_EQ(bounds.upper, (Double3{101, 1, 1}));
}

// Shapes around those that are taken back keep their meshes.
TEST(KeptInstances, LeaveOtherShapesAsTheyWere) {
    const std::string around = "<shape type=\"rectangle\" id=\"before\"/>" + group_of("<shape type=\"cube\"/>") +
                               group_of("<shape type=\"disk\" id=\"single\"/>", "alone") + instance_of("", "alone") +
                               instance_of("<translate x=\"1\"/>") + "<shape type=\"sphere\"/>" +
                               "<shape type=\"disk\" id=\"between\"/>" + instance_of("<translate x=\"2\"/>") +
                               instance_of("<translate x=\"3\"/>") + "<shape type=\"rectangle\" id=\"after\"/>";
    const Scene scene = loaded_as(around, InstanceChoice::automatic, 0);
    EXPECT_EQ(scene.instances.size(), 3u);
    EXPECT_EQ(scene.copied_instances, 1u);
    std::string shapes;
    for (const Shape &shape : scene.shapes) {
        const std::size_t triangles =
            shape.kind == Shape::Kind::mesh ? scene.meshes.at(shape.geometry).triangles.size() : 0;
        shapes += fmt::format("{}{} ", triangles, shape.group == no_group ? "" : " shared");
    }
    EXPECT_EQ(shapes, "2 256 0 256 12 shared 2 ") << "rectangle, disk, sphere, disk, cube, rectangle";
    EXPECT_EQ(scene.meshes.size(), 5u);
}

TEST(KeptInstances, CopyWhatTheyCannotBe) {
    const std::string body =
        group_of("<shape type=\"cube\"/><shape type=\"sphere\"/><shape type=\"rectangle\"><emitter "
                 "type=\"area\"/></shape>") +
        instance_of("<translate x=\"1\"/>") + instance_of("<translate x=\"2\"/>") +
        instance_of("<scale z=\"1e-12\"/>", "flat") + group_of("<shape type=\"rectangle\"/>", "flat");
    const Scene scene = loaded_as(body, InstanceChoice::kept);
    EXPECT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.spheres.size(), 2u);
    EXPECT_EQ(scene.emitters.size(), 2u);
    std::size_t shared = 0;
    for (const Shape &shape : scene.shapes) {
        shared += shape.group != no_group;
        EXPECT_TRUE(shape.group == no_group || shape.emitter < 0);
    }
    EXPECT_EQ(shared, 1u);
}

// Its textures and what is brushed turn with it.
TEST(CopiedInstances, TurnTheAxesOfSpheres) {
    const Scene scene = loaded_as(
        group_of("<shape type=\"sphere\"><transform name=\"to_world\"><rotate x=\"1\" angle=\"90\"/></transform>"
                 "</shape>") +
            instance_of("<rotate z=\"1\" angle=\"90\"/><scale value=\"3\"/>"),
        InstanceChoice::automatic);
    const auto [x, y, z] = scene.spheres.at(0).axes; // x to y; y to z; z to -y to x
    expect_vector(x, 0, 1, 0);
    expect_vector(y, 0, 0, 1);
    expect_vector(z, 1, 0, 0);
}

TEST(KeptInstances, OfASingularMapAreErrorsWithTheirLine) {
    const std::string body = group_of("<shape type=\"cube\"/>") + instance_of("\n<scale x=\"0\"/>");
    const std::string message = error_of_text(scene_around(body, "3.0.0", ""));
    EXPECT_THAT(message, HasSubstr("scene.xml:4"));
    EXPECT_THAT(message, HasSubstr("cannot be undone"));
    EXPECT_THAT(error_of_text(scene_around(group_of("<shape type=\"cube\"/>") +
                                           instance_of("\n<matrix value=\"1 0 0 0 0 1 0 0 0 0 nan 0 0 0 0 1\"/>"))),
                HasSubstr("scene.xml:5"));
}

TEST(KeptInstances, OfAGroupInAGroupAreErrors) {
    const std::string inner = "\n<shape type=\"shapegroup\" id=\"i\"><shape type=\"cube\"/></shape>";
    const std::string message =
        error_of_text(scene_around(group_of("<shape type=\"cube\"/>" + inner) + instance_of("")));
    EXPECT_THAT(message, HasSubstr("scene.xml:4: a shapegroup in a shapegroup is not supported"));
    EXPECT_THAT(error_of_text(scene_around(inner + group_of("<ref id=\"i\"/>") + instance_of(""))),
                HasSubstr("a shapegroup in a shapegroup"));
}

TEST(KeptInstances, CountAgainstTheLimits) {
    LoadOptions options;
    options.instances = InstanceChoice::copies;
    options.limits.geometry_bytes = 1500;
    const std::string body = scene_around(two_cubes, "3.0.0", "");
    EXPECT_THAT(error_of_text(body, options), HasSubstr("scene.xml:5"));
    EXPECT_THAT(error_of_text(body, options), HasSubstr("--limits 10"));
}

} // namespace
} // namespace gradus
