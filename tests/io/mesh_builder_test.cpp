// From the mesh of a file to the mesh in the world: sides, normals, degenerate triangles.
#include "runtime/scene/mesh_builder.h"

#include "runtime/scene/transform.h"
#include "tests/io/mesh_text.h"
#include "tests/io/scene_text.h"

#include <cmath>
#include <limits>

namespace gradus {
namespace {

Mesh flat_triangle() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    return mesh;
}

/// The unit geometric normal of triangle `index`.
Double3 geometric_normal(const Mesh &mesh, std::size_t index) {
    const auto &t = mesh.triangles.at(index);
    const Double3 p0 = to_double(mesh.positions[t[0]]);
    return normalize(
        cross(subtract(to_double(mesh.positions[t[1]]), p0), subtract(to_double(mesh.positions[t[2]]), p0)));
}

const Matrix4 mirror = scaling({-1, 1, 1});

TEST(BuildMesh, SidesOfMirroredMeshes) {
    // As Mitsuba 3 has it: without vertex normals the winding in world space decides, so a mirror turns the side.
    EXPECT_GT(geometric_normal(build_mesh(flat_triangle(), {}, {}).mesh, 0)[2], 0);
    EXPECT_LT(geometric_normal(build_mesh(flat_triangle(), mirror, {}).mesh, 0)[2], 0);
    // With vertex normals, they decide.
    Mesh with_normals = flat_triangle();
    with_normals.normals.assign(3, {0, 0, 1});
    const Mesh mirrored = build_mesh(with_normals, mirror, {}).mesh;
    EXPECT_GT(geometric_normal(mirrored, 0)[2], 0);
    expect_vector(mirrored.normals[0], 0, 0, 1);
    // Told to forget them, the winding decides again.
    MeshOptions flat;
    flat.face_normals = true;
    const Mesh forgotten = build_mesh(with_normals, mirror, flat).mesh;
    EXPECT_LT(geometric_normal(forgotten, 0)[2], 0);
    EXPECT_TRUE(forgotten.normals.empty());
    // Rectangles and cubes have normals of their own.
    MeshOptions primitive;
    primitive.front_from_local_winding = true;
    primitive.compute_normals = false;
    EXPECT_GT(geometric_normal(build_mesh(flat_triangle(), mirror, primitive).mesh, 0)[2], 0);
}

TEST(BuildMesh, FlipTurnsNormalsAndWinding) {
    MeshOptions flip;
    flip.flip_normals = true;
    Mesh mesh = flat_triangle();
    mesh.normals.assign(3, {0, 0, 1});
    const Mesh flipped = build_mesh(mesh, {}, flip).mesh;
    EXPECT_LT(geometric_normal(flipped, 0)[2], 0);
    expect_vector(flipped.normals[1], 0, 0, -1);
}

TEST(BuildMesh, TrianglesWoundAgainstTheirNormalsAreTurned) {
    Mesh mesh = folded_square();
    std::swap(mesh.triangles[1][1], mesh.triangles[1][2]);
    const Mesh built = build_mesh(mesh, {}, {}).mesh;
    EXPECT_GT(geometric_normal(built, 0)[2], 0);
    EXPECT_GT(geometric_normal(built, 1)[2], 0);
}

TEST(BuildMesh, NormalsFollowTheInverseTranspose) {
    Mesh mesh = flat_triangle();
    const float s = std::sqrt(0.5f);
    mesh.normals.assign(3, {s, 0, s});
    // Squeezed by half along x, the normal's x counts twice: (2, 0, 1) / sqrt(5).
    const Mesh built = build_mesh(mesh, scaling({0.5, 1, 1}), {}).mesh;
    expect_vector(built.normals[0], 2 / std::sqrt(5.0), 0, 1 / std::sqrt(5.0));
}

TEST(BuildMesh, ComputedNormalsAreWeightedByAngle) {
    Mesh mesh = folded_square();
    mesh.normals.clear();
    // What Mitsuba 3.9 computes for these triangles.
    const Mesh built = build_mesh(mesh, {}, {}).mesh;
    expect_vector(built.normals[0], 0.2270461, -0.2270461, 0.94704807, 1e-6);
    expect_vector(built.normals[1], 0, 0, 1, 1e-6);
    expect_vector(built.normals[3], 0.40824828, -0.40824828, 0.81649655, 1e-6);
    // By hand at vertex 0: 45 degrees of (0, 0, 1), acos(1 / sqrt(2.5)) of (1, -1, 2) / sqrt(6).
    const double a = std::acos(-1.0) / 4, b = std::acos(1 / std::sqrt(2.5));
    const Double3 sum{b / std::sqrt(6.0), -b / std::sqrt(6.0), a + 2 * b / std::sqrt(6.0)};
    const Double3 expected = normalize(sum);
    expect_vector(built.normals[0], expected[0], expected[1], expected[2], 1e-6);
}

TEST(BuildMesh, MissingNormalsAreFilledIn) {
    Mesh mesh = flat_triangle();
    mesh.normals = {{0, 0, 1}, {0, 0, 0}, {std::numeric_limits<float>::quiet_NaN(), 0, 0}};
    for (const Vector3 &normal : build_mesh(mesh, {}, {}).mesh.normals)
        expect_vector(normal, 0, 0, 1);
}

TEST(BuildMesh, DegenerateTrianglesAreDropped) {
    Mesh mesh = folded_square();
    mesh.positions.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
    mesh.positions.push_back({2, 0, 0});
    mesh.normals.resize(6, {0, 0, 1});
    mesh.texcoords.resize(6);
    mesh.triangles.push_back({0, 1, 4}); // not a number
    mesh.triangles.push_back({0, 1, 5}); // in one line
    mesh.triangles.push_back({2, 2, 3}); // a corner twice
    const BuiltMesh built = build_mesh(mesh, {}, {});
    EXPECT_EQ(built.degenerate, 3u);
    EXPECT_EQ(built.mesh.triangles.size(), 2u);
    for (const Vector3 &p : built.mesh.positions)
        EXPECT_TRUE(std::isfinite(p.x));
    EXPECT_NEAR(surface_area(built.mesh), 0.5 + 0.5 * std::sqrt(1.5), 1e-6);
}

TEST(BuildMesh, TinyAndThinTrianglesAreKept) {
    EXPECT_EQ(build_mesh(flat_triangle(), scaling({1e-6, 1e-6, 1e-6}), {}).degenerate, 0u);
    EXPECT_EQ(build_mesh(flat_triangle(), scaling({1e4, 1, 1}), {}).degenerate, 0u);
}

TEST(BuildMesh, FlattenedMeshKeepsTheNormalsOfItsPlane) {
    MeshOptions primitive;
    primitive.front_from_local_winding = true;
    const BuiltMesh built = build_mesh(flat_triangle(), scaling({1, 1, 0}), primitive);
    EXPECT_EQ(built.degenerate, 0u);
    EXPECT_GT(geometric_normal(built.mesh, 0)[2], 0);
}

TEST(BuildMesh, OverflowDropsTheTriangle) {
    const BuiltMesh built = build_mesh(flat_triangle(), scaling({1e60, 1, 1}), {});
    EXPECT_EQ(built.degenerate, 1u);
    EXPECT_TRUE(built.mesh.triangles.empty());
}

TEST(MeshBuilder, VerticesThatWereOneShareAComputedNormal) {
    // Two triangles at a right angle along one edge, whose vertices are there twice.
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, -1}};
    mesh.triangles = {{0, 1, 2}, {3, 5, 4}};
    const auto normals = [&] { return build_mesh(mesh, Matrix4(), {}).mesh.normals; };
    EXPECT_NE(normals()[0], normals()[3]);
    mesh.normal_of = {0, 1, 2, 0, 1, 5};
    const std::vector<Vector3> shared = normals();
    EXPECT_EQ(shared[0], shared[3]);
    EXPECT_EQ(shared[1], shared[4]);
    EXPECT_NEAR(shared[0].y, -shared[0].z, 1e-6);
    EXPECT_GT(shared[0].z, 0.7f);
    EXPECT_NE(shared[2], shared[5]);
    EXPECT_TRUE(build_mesh(mesh, Matrix4(), {}).mesh.normal_of.empty());
}

} // namespace
} // namespace gradus
