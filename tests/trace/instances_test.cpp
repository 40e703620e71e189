// Rays that start at surfaces of instances do not meet these, whatever the map; and each hit is where a copy would be.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <unistd.h>

#include "runtime/scene/instances.h"
#include "runtime/scene/scene_tables.h"
#include "runtime/trace/tracer.h"

#define TRAIT_TRIANGLES 1
#define TRAIT_SPHERES 0
#define TRAIT_INDEXED 3
#define TRAIT_INSTANCES 1
#include "kernels/lib/frame.h"
#include "kernels/lib/scene_hit.h"
#include "kernels/shared/tables.h"

namespace gradus::testing {
namespace {

using namespace lib_float;

constexpr std::uint32_t unit = 1; // of FIELD_OF

class Dice {
  public:
    explicit Dice(std::uint64_t seed) : bits_(seed) {}
    double uniform() { return std::uniform_real_distribution<double>(0, 1)(bits_); }
    double normal() { return std::normal_distribution<double>()(bits_); }
    /// From 10^low to 10^high.
    double magnitude(double low, double high) { return std::pow(10, low + (high - low) * uniform()); }
    Double3 direction() { return normalize({normal(), normal(), normal()}); }

  private:
    std::mt19937_64 bits_;
};

vec3 to_vec3(const Double3 &v) { return v3(float(v[0]), float(v[1]), float(v[2])); }

/// A parallelogram of size 1 about a place of the group's frame, which the map takes to about another of the world.
Scene placed_parallelogram(Dice &dice, const Double3 &place, const Double3 &to, double steepest) {
    const Double3 u = dice.direction(), v = dice.direction();
    const Double3 corner = subtract(subtract(place, scale(u, 0.4)), scale(v, 0.4));
    Mesh mesh;
    for (const Double3 &p : {corner, add(corner, u), add(add(corner, u), v), add(corner, v)})
        mesh.positions.push_back(to_float(p));
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    Matrix4 map;
    do {
        const double stretched = dice.magnitude(-std::log10(steepest), 0), size = dice.magnitude(-2, 2);
        map = multiply(rotation(dice.direction(), 360 * dice.uniform()),
                       multiply(scaling({size, (dice.uniform() < 0.5 ? -1 : 1) * size * stretched, size}),
                                rotation(dice.direction(), 360 * dice.uniform())));
    } while (!can_be_instance(map));
    const Double3 moved = subtract(to, transform_point(map, place));
    map = multiply(translation(moved), map);
    Scene scene;
    scene.materials.resize(1);
    scene.meshes.push_back(mesh);
    scene.shapes.emplace_back().group = 0;
    scene.groups = 1;
    scene.instances.push_back(make_instance(0, map));
    return scene;
}

struct Placed {
    explicit Placed(const Scene &scene)
        : tables(make_scene_tables(scene, scene_traits(scene))), tracer(scene, 1, &tables),
          instance(tables.no_instance + 1) {}
    const float *triangles() const { return tables.triangles.data(); }
    SceneTables tables;
    Tracer tracer;
    std::uint32_t instance;
};

struct Rays {
    std::vector<float> origin[3], direction[3];
    std::vector<std::uint32_t> primitive, instance;

    void add(vec3 from, vec3 way) {
        const float values[] = {from.x, from.y, from.z, way.x, way.y, way.z};
        for (int axis = 0; axis < 3; ++axis) {
            origin[axis].push_back(values[axis]);
            direction[axis].push_back(values[3 + axis]);
        }
        primitive.push_back(ray_pending);
        instance.push_back(0);
    }
    void trace(Tracer &tracer) {
        RayColumns columns{};
        for (int axis = 0; axis < 3; ++axis) {
            columns.origin[axis] = origin[axis].data();
            columns.direction[axis] = direction[axis].data();
        }
        columns.primitive = primitive.data();
        columns.instance = instance.data();
        tracer.trace(columns, primitive.size(), ShadowColumns{}, 0);
    }
};

/// The share of rays from points of such instances that meet anything.
double share_that_is_caught(std::uint64_t seed, double farthest, double steepest, float times) {
    Dice dice(seed);
    constexpr int scenes = 2000, rays_a_scene = 64;
    double caught = 0;
    for (int i = 0; i < scenes; ++i) {
        const auto place = [&] {
            return scale(dice.direction(), dice.uniform() < 0.3 ? 0 : dice.magnitude(-2, farthest));
        };
        const Double3 in_group = place(), in_world = place();
        const Scene scene = placed_parallelogram(dice, in_group, in_world, steepest);
        Placed placed(scene);
        Rays rays;
        for (int ray = 0; ray < rays_a_scene; ++ray) {
            const auto primitive = std::uint32_t(ray % 2);
            double u = dice.uniform(), v = dice.uniform();
            if (u + v > 1)
                u = 1 - u, v = 1 - v;
            const scene_triangle t = scene_triangle_of(placed.triangles(), unit, primitive, placed.instance);
            const vec3 target = v3_mad(v3_mad(t.p0, float(u), t.e1), float(v), t.e2);
            const vec3 way = to_vec3(dice.direction());
            const float size = std::sqrt(v3_dot(t.e1, t.e1));
            const primitive_hit hit = primitive_hit_of(placed.triangles(), nullptr, unit, 2, primitive, placed.instance,
                                                       v3_mad(target, -size * float(dice.magnitude(-2, 1)), way), way);
            const real offset = offset_at(hit.position, hit.normal,
                                          primitive_offset(placed.triangles(), nullptr, unit, 2, primitive, hit));
            const double cosine = dice.uniform() < 0.5 ? dice.uniform() : dice.magnitude(-4, 0);
            const double angle = 6.283185307 * dice.uniform(), sine = std::sqrt(1 - cosine * cosine);
            const double side = dice.uniform() < 0.5 ? 1 : -1;
            const vec3 out =
                frame_to_world(frame_from_normal(hit.normal),
                               v3(float(sine * std::cos(angle)), float(sine * std::sin(angle)), float(side * cosine)));
            rays.add(ray_origin(hit.position, hit.normal, times * offset, out), out);
        }
        rays.trace(placed.tracer);
        caught += double(std::count_if(rays.primitive.begin(), rays.primitive.end(),
                                       [](std::uint32_t primitive) { return primitive != ray_escaped; }));
    }
    return caught / (scenes * rays_a_scene);
}

TEST(InstanceTracing, RaysLeaveWhateverTheMap) {
    EXPECT_EQ(share_that_is_caught(1, 3, 1, 1), 0) << "turned, scaled and mirrored";
    EXPECT_EQ(share_that_is_caught(2, 3, 30, 1), 0) << "stretched";
}

// What makes the test above one that can fail.
TEST(InstanceTracing, RaysAreCaughtWhereTheyStartTooNear) { EXPECT_GT(share_that_is_caught(1, 3, 1, 1 / 32.f), 1e-4); }

// Which instance was met, and where, its front where the mapped normal points.
TEST(InstanceTracing, HitsAreWhereTheMapTakesThem) {
    Dice dice(3);
    for (int i = 0; i < 200; ++i) {
        const Scene scene = placed_parallelogram(dice, scale(dice.direction(), 2), scale(dice.direction(), 3), 10);
        Placed placed(scene);
        const Matrix4 map = matrix_of(scene.instances[0]);
        const Mesh &mesh = scene.meshes[0];
        const auto corner = [&](std::size_t at) { return to_double(mesh.positions[mesh.triangles[1][at]]); };
        const Double3 local = add(scale(corner(0), 0.2), add(scale(corner(1), 0.5), scale(corner(2), 0.3)));
        const Double3 normal =
            normalize(NormalMap(map)(cross(subtract(corner(1), corner(0)), subtract(corner(2), corner(0)))));
        const Double3 target = transform_point(map, local);
        const double size = length(transform_vector(map, subtract(corner(1), corner(0))));
        Rays rays;
        rays.add(to_vec3(add(target, scale(normal, size))), to_vec3(scale(normal, -1)));
        rays.trace(placed.tracer);
        ASSERT_EQ(rays.primitive[0], 1u);
        ASSERT_EQ(rays.instance[0], placed.instance);
        const primitive_hit hit =
            primitive_hit_of(placed.triangles(), nullptr, unit, 2, 1, placed.instance,
                             to_vec3(add(target, scale(normal, size))), to_vec3(scale(normal, -1)));
        EXPECT_LT(v3_dot(v3_sub(hit.normal, to_vec3(normal)), v3_sub(hit.normal, to_vec3(normal))), 1e-8f);
        EXPECT_LT(length(subtract({hit.position.x, hit.position.y, hit.position.z}, target)), 1e-5 * (size + 10));
        EXPECT_NEAR(hit.u, 0.5, 1e-3);
        EXPECT_NEAR(hit.v, 0.3, 1e-3);
    }
}

// What is in no instance has the record that says so, though an instance behind it may have been met before.
TEST(InstanceTracing, ASphereBeforeAnInstanceIsOfNone) {
    Dice dice(5);
    for (int i = 0; i < 50; ++i) {
        Scene scene = placed_parallelogram(dice, {0, 0, 0}, {0, 0, 0}, 1);
        const Matrix4 map = matrix_of(scene.instances[0]);
        const Mesh &mesh = scene.meshes[0];
        const Double3 target =
            transform_point(map, scale(add(to_double(mesh.positions[0]), to_double(mesh.positions[2])), 0.5));
        const Double3 way = dice.direction();
        scene.spheres.push_back({to_float(add(target, scale(way, 3))), 1, false});
        scene.shapes.emplace_back().kind = Shape::Kind::sphere;
        Placed placed(scene);
        Rays rays;
        for (int ray = 0; ray < 32; ++ray)
            rays.add(to_vec3(add(target, scale(way, ray % 2 == 0 ? 10 : 1.5))), to_vec3(scale(way, -1)));
        rays.trace(placed.tracer);
        for (std::size_t ray = 0; ray < 32; ++ray) {
            const bool is_sphere = ray % 2 == 0;
            EXPECT_EQ(rays.primitive[ray] == 2, is_sphere);
            EXPECT_EQ(rays.instance[ray], is_sphere ? placed.tables.no_instance : placed.instance);
        }
    }
}

std::size_t resident_bytes() {
    std::size_t all = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> all >> resident;
    return resident * std::size_t(sysconf(_SC_PAGESIZE));
}

// What driver/scene_summary.cpp says that Embree takes for an instance; its own count has the tree alone.
TEST(InstanceTracing, TakesSoMuchMemory) {
    Dice dice(4);
    Scene scene = placed_parallelogram(dice, {0, 0, 0}, {0, 0, 0}, 1);
    constexpr std::size_t count = 200'000;
    scene.instances.clear();
    for (std::size_t i = 0; i < count; ++i)
        scene.instances.push_back(make_instance(0, translation(scale(dice.direction(), 100))));
    const SceneTables tables = make_scene_tables(scene, scene_traits(scene));
    const std::size_t before = resident_bytes();
    const Tracer tracer(scene, 0, &tables);
    const double an_instance = double(resident_bytes() - before) / double(count);
    std::printf("an instance takes %.0f bytes; Embree counts %.0f\n", an_instance,
                double(tracer.memory_bytes()) / double(count));
#ifdef __SANITIZE_ADDRESS__
    constexpr double most = 1000; // it keeps room around each allocation
#else
    constexpr double most = 500;
#endif
    EXPECT_LT(an_instance, most);
}

} // namespace
} // namespace gradus::testing
