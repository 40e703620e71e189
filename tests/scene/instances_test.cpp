// Records of instances, against the maps in double.
#include "runtime/scene/instances.h"
#include "runtime/scene/mesh_builder.h"

#include <gtest/gtest.h>

#include <random>

#include "kernels/lib/instance.h"

namespace gradus {
namespace {

using namespace lib_float;

constexpr std::uint32_t unit = 1; // of FIELD_OF

/// A unit cube as group 0, with one instance.
Scene cube_at(const Matrix4 &to_world) {
    Scene scene;
    Mesh mesh;
    for (int corner = 0; corner < 8; ++corner)
        mesh.positions.push_back({float(corner & 1), float(corner >> 1 & 1), float(corner >> 2)});
    mesh.triangles = {{0, 1, 2}, {5, 6, 7}, {3, 4, 0}};
    scene.meshes.push_back(mesh);
    scene.shapes.emplace_back().group = 0;
    scene.groups = 1;
    scene.instances.push_back(make_instance(0, to_world));
    return scene;
}

Matrix4 random_map(std::mt19937 &bits) {
    std::uniform_real_distribution<double> number(-2, 2);
    Matrix4 map;
    for (std::size_t i = 0; i < 12; ++i)
        map.m[i] = float(number(bits));
    return map;
}

std::vector<float> records_of(const Matrix4 &map) {
    std::vector<float> records(2 * instance_stride);
    put_instances(cube_at(map), records.data());
    return records;
}

TEST(InstanceRecord, TakesPointsVectorsAndNormals) {
    std::mt19937 bits(1);
    int mirrored = 0;
    for (int i = 0; i < 1000; ++i) {
        const Matrix4 map = random_map(bits);
        if (!can_be_instance(map))
            continue;
        mirrored += determinant(map) < 0;
        const std::vector<float> records = records_of(map);
        const instance_map found = instance_map_of(records.data(), unit, 1);
        std::normal_distribution<double> normal;
        const Double3 p{normal(bits), normal(bits), normal(bits)};
        const vec3 local = v3(float(p[0]), float(p[1]), float(p[2]));
        const auto difference = [](vec3 a, const Double3 &b) { return length(subtract({a.x, a.y, a.z}, b)); };
        // Four roundings of terms of 2 times the largest of p.
        const double tolerance = 1e-5 * (1 + length(p));
        EXPECT_LT(difference(placed_point(found, local), transform_point(map, p)), tolerance);
        EXPECT_LT(difference(placed_vector(found, local), transform_vector(map, p)), tolerance);
        const Double3 expected = normalize(NormalMap(map)(p));
        // Rounding in the cofactors, relative to the shortest direction that a map of this skew has.
        EXPECT_LT(difference(v3_normalize(placed_normal(found, local)), expected), 1e-2) << i;
        EXPECT_EQ(found.facing, determinant(map) < 0 ? -1 : 1);
    }
    EXPECT_GT(mirrored, 300);
}

TEST(InstanceRecord, OfNoneLeavesAllWhereItIs) {
    const std::vector<float> records = records_of(translation({1, 2, 3}));
    const instance_map none = instance_map_of(records.data(), unit, 0);
    const vec3 v = v3(0.1f, -3e7f, 2e-20f), p = placed_point(none, v), n = placed_normal(none, v);
    EXPECT_EQ(p.x, v.x);
    EXPECT_EQ(p.y, v.y);
    EXPECT_EQ(p.z, v.z);
    EXPECT_EQ(n.x, v.x);
    EXPECT_EQ(n.y, v.y);
    EXPECT_EQ(n.z, v.z);
    EXPECT_EQ(instance_rounding(records.data(), unit, 0, v3(1, 1, 1)), 0);
}

// Copies keep the proportions of mapped normals, so that what is interpolated is what an instance has.
TEST(InstanceRecord, HasTheNormalsOfCopies) {
    std::mt19937 bits(2);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 200; ++i) {
        const Matrix4 map = random_map(bits);
        if (!can_be_instance(map) || std::fabs(determinant(map)) < 0.1)
            continue;
        Mesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        for (int corner = 0; corner < 3; ++corner)
            mesh.normals.push_back(to_float(normalize({0.3 * normal(bits), 0.3 * normal(bits), 1})));
        mesh.triangles = {{0, 1, 2}};
        MeshOptions options;
        options.front_from_local_winding = options.normals_keep_proportions = true;
        const Mesh copy = build_mesh(mesh, map, options).mesh;
        const std::vector<float> records = records_of(map);
        const auto mean = [](const Mesh &of) {
            vec3 sum = v3(0, 0, 0);
            for (std::size_t corner = 0; corner < 3; ++corner)
                sum = v3_add(sum, v3(of.normals[corner].x, of.normals[corner].y, of.normals[corner].z));
            return sum;
        };
        const vec3 placed = v3_normalize(placed_normal(instance_map_of(records.data(), unit, 1), mean(mesh)));
        EXPECT_GT(v3_dot(placed, v3_normalize(mean(copy))), 1 - 1e-5f);
    }
}

TEST(Instance, CanOnlyBeWhatCanBeUndone) {
    EXPECT_TRUE(can_be_instance(scaling({-1, 0.01, 100})));
    EXPECT_TRUE(is_invertible(scaling({1e-6, 1e-6, 1e-6})));
    EXPECT_FALSE(is_invertible(scaling({1, 0, 1})));
    EXPECT_FALSE(can_be_instance(scaling({1, 1, 1e-12})));
    Matrix4 sheared;
    sheared.m[1] = 1e5;
    EXPECT_TRUE(is_invertible(sheared));
    EXPECT_FALSE(can_be_instance(sheared)) << "rounding of its inverse would show";
}

TEST(Instance, IsWithinTheBoundsOfTheScene) {
    const Bounds bounds = world_bounds(cube_at(multiply(translation({5, 0, 0}), scaling({-2, 1, 1}))));
    EXPECT_EQ(bounds.lower, (Double3{3, 0, 0}));
    EXPECT_EQ(bounds.upper, (Double3{5, 1, 1}));
}

} // namespace
} // namespace gradus
