// Tables of many triangles: what they take, and that they say what tables of few do.
#include "runtime/scene/vertex_table.h"

#include "runtime/scene/mesh_builder.h"
#include "runtime/scene/scene_tables.h"
#include "runtime/scene/transform.h"
#include "tests/support/small_scenes.h"
#include "tests/support/textures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

// After GoogleTest, which has template parameters of the names of its macros.
#include "kernels/lib/scene_triangle.h"

namespace gradus::testing {
namespace {

using namespace lib_float;

/// A wavy sheet of 2 side^2 triangles, as a reader gives it.
Mesh sheet(std::size_t side, bool has_normals, bool has_uv) {
    Mesh mesh;
    for (std::size_t y = 0; y <= side; ++y)
        for (std::size_t x = 0; x <= side; ++x) {
            const float u = float(x) / float(side), v = float(y) / float(side);
            mesh.positions.push_back({u, v, 0.1f * std::sin(9 * u)});
            if (has_normals)
                mesh.normals.push_back({-0.6f, 0, 0.8f});
            if (has_uv)
                mesh.texcoords.push_back({u, v});
        }
    for (std::size_t y = 0; y < side; ++y)
        for (std::size_t x = 0; x < side; ++x) {
            const auto a = std::uint32_t(y * (side + 1) + x), b = a + 1, c = std::uint32_t(a + side + 1), d = c + 1;
            mesh.triangles.push_back({a, b, d});
            mesh.triangles.push_back({a, d, c});
        }
    return mesh;
}

/// What a binary PLY file has of it: floats, and three indices behind a count of one byte.
std::uint64_t ply_bytes(const Mesh &mesh) {
    return mesh.positions.size() * 12 + mesh.normals.size() * 12 + mesh.texcoords.size() * 8 +
           mesh.triangles.size() * 13;
}

TraitMap by_index(const Scene &scene) {
    TraitMap traits = scene_traits(scene);
    traits["TRAIT_INDEXED"] = indexed_trait(traits, std::numeric_limits<std::size_t>::max());
    return traits;
}

Bsdf checkered(SceneMaker &maker) {
    maker.scene.textures.push_back(random_texture());
    Bsdf bsdf;
    bsdf.reflectance.texture = std::int32_t(maker.scene.textures.size() - 1);
    return bsdf;
}

struct SheetCase {
    const char *name;
    bool normals, uv, face_normals;
};

class Sheets : public ::testing::TestWithParam<SheetCase> {};

// 1.5 times what the file holds is what is asked; of the rest of the tables a scene of one material has a kilobyte, of
// a texture of 35 texels as little.
TEST_P(Sheets, TakeAtMostHalfAsMuchAgainAsTheirFiles) {
    const auto [name, normals, uv, face_normals] = GetParam();
    const Mesh in_file = sheet(200, normals, uv);
    MeshOptions options;
    options.face_normals = face_normals;
    SceneMaker maker(4, 1);
    maker.scene.meshes.push_back(build_mesh(in_file, Matrix4(), options).mesh);
    maker.shape(Shape::Kind::mesh, 0, maker.material(uv ? checkered(maker) : diffuse(0.5)), -1);
    const TraitMap traits = scene_traits(maker.scene);
    ASSERT_GT(traits.at("TRAIT_INDEXED"), 0) << "80,000 triangles are many";
    const SceneTables tables = make_scene_tables(maker.scene, traits);
    const double times = double(table_bytes(tables)) / double(ply_bytes(in_file));
    std::printf("%s: tables of %.3f times the file's bytes\n", name, times);
    EXPECT_LE(times, 1.5);
    EXPECT_NEAR(double(geometry_table_bytes(maker.scene, traits)), double(table_bytes(tables)), 4096);
}

INSTANTIATE_TEST_SUITE_P(Of, Sheets,
                         ::testing::Values(SheetCase{"positions", false, false, false},
                                           SheetCase{"flat", false, false, true},
                                           SheetCase{"normals", true, false, false},
                                           SheetCase{"normals_and_uv", true, true, false}),
                         [](const auto &parameter) { return parameter.param.name; });

/// Meshes with and without normals, (u, v), attributes and light, in one scene.
Scene mixed_scene() {
    SceneMaker maker(4, 1);
    const std::uint32_t plain = maker.material(diffuse(0.5)), textured = maker.material(checkered(maker));
    Texture by_vertex;
    by_vertex.kind = Texture::Kind::mesh_attribute;
    by_vertex.attribute = "vertex_color";
    maker.scene.textures.push_back(by_vertex);
    const auto add = [&](Mesh mesh, std::uint32_t material, std::int32_t emitter = -1) {
        maker.scene.meshes.push_back(std::move(mesh));
        maker.shape(Shape::Kind::mesh, maker.scene.meshes.size() - 1, material, emitter);
    };
    add(sheet(3, true, true), textured);
    maker.sphere({0, 0, 3}, 1, plain, maker.emitter(Emitter::Kind::area, {1, 1, 1}));
    add(sheet(2, true, false), textured);
    add(sheet(3, false, true), plain, maker.emitter(Emitter::Kind::area, {1, 2, 3}));
    add(sheet(2, false, false), plain);
    add(sheet(1, false, true), plain, maker.emitter(Emitter::Kind::area, {0, 0, 0}));
    maker.sphere({0, 0, 6}, 1, plain);
    return maker.scene;
}

TEST(VertexTable, SaysWhatRecordsOfTrianglesSay) {
    const Scene scene = mixed_scene();
    const SceneTables dense = make_scene_tables(scene, scene_traits(scene));
    const SceneTables indexed = make_scene_tables(scene, by_index(scene));
    ASSERT_FALSE(dense.is_indexed());
    ASSERT_EQ(indexed.vertex_numbers, 8u);
    ASSERT_EQ(indexed.triangle_count, dense.triangle_count);
    ASSERT_EQ(indexed.primitive_count, dense.primitive_count);
    for (std::uint32_t i = 0; i < dense.triangle_count; ++i) {
        const TableTriangle a = dense.triangle(i), b = indexed.triangle(i);
        EXPECT_EQ(a.p0, b.p0) << "triangle " << i;
        EXPECT_EQ(a.e1, b.e1) << "triangle " << i;
        EXPECT_EQ(a.e2, b.e2) << "triangle " << i;
        if (i < 18 + 8) { // the textured ones; of others nobody reads them
            EXPECT_EQ(dense.texcoords(i), indexed.texcoords(i)) << "triangle " << i;
        }
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const float *vertex = &indexed.triangles[std::size_t(b.corners[corner]) * 8];
            const bool has_normal = i < 18 + 8;
            EXPECT_EQ(vertex[3], has_normal ? dense.triangle_normals[i * normals_stride + 3 * corner] : 0) << i;
        }
    }
    for (std::uint32_t i = 0; i < dense.primitive_count; ++i) {
        EXPECT_EQ(dense.light_of(i), indexed.light_of(i)) << "primitive " << i;
        const std::uint32_t *surface = &indexed.primitive_surface[indexed.primitive_surface[i]];
        EXPECT_EQ(surface[surface_of_material], dense.primitive_material[i]) << "primitive " << i;
        EXPECT_EQ(surface[surface_of_bin], dense.primitive_bin[i]) << "primitive " << i;
        EXPECT_EQ(surface[surface_of_back_bin], dense.primitive_back_bin[i]) << "primitive " << i;
    }
}

// Products of edges are off by 2^-24 of the edges' product in float, and so by that times the slant of their area,
// twice; a root halves it, and each further operation adds half of 2^-23.
TEST(VertexTable, OffsetsOfKernelsAreThoseOfRecords) {
    SceneMaker maker(4, 1);
    const std::uint32_t material = maker.material(diffuse(0.5));
    for (int i = 0; i < 400; ++i) {
        const float angle = 0.37f * float(i), size = std::pow(10.0f, float(i % 9) - 4);
        const float thin = std::pow(10.0f, -float(i % 6) / 2);
        maker.parallelogram({1, 2, 3}, {size * std::cos(angle), size * std::sin(angle), 0.3f * size},
                            {size * (std::cos(angle) + thin), size * std::sin(angle), 0.3f * size}, material);
    }
    const SceneTables tables = make_scene_tables(maker.scene, scene_traits(maker.scene));
    for (std::uint32_t i = 0; i < tables.triangle_count; ++i) {
        const TableTriangle t = tables.triangle(i);
        const auto vector = [](const std::array<float, 3> &a) { return v3(a[0], a[1], a[2]); };
        const vec3 e1 = vector(t.e1), e2 = vector(t.e2);
        const vec3 area = v3_cross(e1, e2);
        const double slant =
            std::sqrt(double(v3_dot(e1, e1)) * double(v3_dot(e2, e2)) / std::max(1e-37, double(v3_dot(area, area))));
        const double record = tables.triangles[std::size_t(i) * triangle_stride + triangle_offset];
        EXPECT_NEAR(triangle_offset_of(e1, e2), record, record * 0x1p-24 * (8 + 4 * slant)) << "slant " << slant;
    }
}

} // namespace
} // namespace gradus::testing
