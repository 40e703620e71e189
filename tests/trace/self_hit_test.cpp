// Rays that start at surfaces do not meet the surface that they start from, and connections meet neither of their ends,
// for triangles of all shapes and spheres, near the origin and far from it; and they start so near that panes of a few
// units in the last place are not lost.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "runtime/scene/scene_tables.h"

#define TRAIT_TRIANGLES 1
#define TRAIT_SPHERES 1
#include "kernels/lib/frame.h"
#include "kernels/lib/light.h"
#include "kernels/lib/scene_hit.h"
#include "tests/trace/traced_rays.h"

namespace gradus::testing {
namespace {

using namespace lib_float;

constexpr std::uint32_t unit = 1; // of FIELD_OF

class Chance {
  public:
    explicit Chance(std::uint64_t seed) : bits_(seed) {}
    double uniform() { return std::uniform_real_distribution<double>(0, 1)(bits_); }
    /// From 10^low to 10^high.
    double magnitude(double low, double high) { return std::pow(10, low + (high - low) * uniform()); }
    vec3 direction() {
        std::normal_distribution<double> normal;
        const double x = normal(bits_), y = normal(bits_), z = normal(bits_), length = std::sqrt(x * x + y * y + z * z);
        return v3(float(x / length), float(y / length), float(z / length));
    }

  private:
    std::mt19937_64 bits_;
};

Vector3 to_vector(vec3 v) { return {v.x, v.y, v.z}; }

/// A parallelogram of two triangles about a place, of size 1: wide, narrow, or sheared into a splinter.
Scene parallelogram(Chance &chance, vec3 place, double narrowest) {
    const vec3 a = chance.direction(), b = chance.direction();
    const float aspect = float(chance.magnitude(std::log10(narrowest), 0));
    const double shape = chance.uniform();
    const vec3 u = a, v = shape < 1 / 3. ? b : shape < 2 / 3. ? v3_scale(b, aspect) : v3_mad(a, aspect, b);
    const vec3 corner = v3_mad(v3_mad(place, -0.4f, u), -0.4f, v);
    Mesh mesh;
    mesh.positions = {to_vector(corner), to_vector(v3_add(corner, u)), to_vector(v3_add(v3_add(corner, u), v)),
                      to_vector(v3_add(corner, v))};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return scene_of(std::move(mesh));
}

Scene ball(vec3 place) {
    Scene scene;
    scene.materials.resize(1);
    scene.spheres.push_back({to_vector(place), 1, false});
    scene.shapes.emplace_back().kind = Shape::Kind::sphere;
    return scene;
}

/// How far from the origin, and in which direction.
vec3 random_place(Chance &chance) {
    return v3_scale(chance.direction(), chance.uniform() < 0.3 ? 0 : float(chance.magnitude(-2, 4)));
}

/// A scene and what the kernels compute of it.
struct Surfaces {
    explicit Surfaces(const Scene &scene)
        : tables(make_scene_tables(scene, with_all_traits(scene_traits(scene)))), tracer(scene, 1) {}

    /// A point of a primitive as kernels find it, by a ray from somewhere.
    primitive_hit point(Chance &chance, std::uint32_t primitive) const {
        vec3 target;
        if (primitive < tables.triangle_count) {
            double u = chance.uniform(), v = chance.uniform();
            if (u + v > 1)
                u = 1 - u, v = 1 - v;
            target = v3_mad(v3_mad(FIELD_V3(triangle, tables.triangles.data(), primitive, p0), float(u),
                                   FIELD_V3(triangle, tables.triangles.data(), primitive, e1)),
                            float(v), FIELD_V3(triangle, tables.triangles.data(), primitive, e2));
        } else {
            target = v3_add(FIELD_V3(sphere, tables.spheres.data(), primitive - tables.triangle_count, center),
                            chance.direction());
        }
        const vec3 direction = chance.direction();
        return primitive_hit_of(tables.triangles.data(), tables.spheres.data(), unit, tables.triangle_count, primitive,
                                v3_mad(target, float(-chance.magnitude(-2, 1)), direction), direction);
    }

    float offset(std::uint32_t primitive, const primitive_hit &hit) const {
        return offset_at(
            hit.position, hit.normal,
            primitive_offset(tables.triangles.data(), tables.spheres.data(), unit, tables.triangle_count, primitive));
    }

    std::uint32_t primitives() const { return std::uint32_t(tables.primitive_light.size()); }

    SceneTables tables;
    Tracer tracer;
};

/// Rays or segments, column by column.
struct Batch {
    std::vector<float> origin[3], direction[3];
    std::vector<std::uint32_t> state;

    void add(vec3 from, vec3 way, std::uint32_t initial) {
        const float values[] = {from.x, from.y, from.z, way.x, way.y, way.z};
        for (int axis = 0; axis < 3; ++axis) {
            origin[axis].push_back(values[axis]);
            direction[axis].push_back(values[3 + axis]);
        }
        state.push_back(initial);
    }
    template <class Columns>
    Columns columns() {
        Columns columns{};
        for (int axis = 0; axis < 3; ++axis) {
            columns.origin[axis] = origin[axis].data();
            columns.direction[axis] = direction[axis].data();
        }
        return columns;
    }
};

/// A direction on either side (of spheres outwards), of half of them at grazing angles.
vec3 leaving(Chance &chance, vec3 normal, bool outwards) {
    const double cosine = chance.uniform() < 0.5 ? chance.uniform() : chance.magnitude(-4, 0);
    const double angle = 6.283185307 * chance.uniform(), sine = std::sqrt(1 - cosine * cosine);
    const double side = outwards || chance.uniform() < 0.5 ? 1 : -1;
    return frame_to_world(frame_from_normal(normal),
                          v3(float(sine * std::cos(angle)), float(sine * std::sin(angle)), float(side * cosine)));
}

/// The share of rays from points of the scene's primitives that meet anything. All should escape.
double share_that_hits(Chance &chance, const Scene &scene, std::size_t rays, float scale) {
    Surfaces surfaces(scene);
    Batch batch;
    for (std::size_t i = 0; i < rays; ++i) {
        const auto primitive = std::uint32_t(i % surfaces.primitives());
        const primitive_hit hit = surfaces.point(chance, primitive);
        const vec3 out = leaving(chance, hit.normal, primitive >= surfaces.tables.triangle_count);
        batch.add(ray_origin(hit.position, hit.normal, scale * surfaces.offset(primitive, hit), out),
                  v3_scale(out, float(chance.magnitude(-1, 1))), ray_pending);
    }
    RayColumns columns = batch.columns<RayColumns>();
    columns.primitive = batch.state.data();
    surfaces.tracer.trace(columns, rays, ShadowColumns{}, 0);
    return double(std::count_if(batch.state.begin(), batch.state.end(),
                                [](std::uint32_t primitive) { return primitive != ray_escaped; })) /
           double(rays);
}

constexpr std::size_t rays_a_scene = 64;

double share_of_parallelograms(std::uint64_t seed, double narrowest, float scale) {
    Chance chance(seed);
    double sum = 0;
    constexpr int scenes = 2000;
    for (int i = 0; i < scenes; ++i)
        sum += share_that_hits(chance, parallelogram(chance, random_place(chance), narrowest), rays_a_scene, scale);
    return sum / scenes;
}

// The other triangle of the parallelogram counts too: rays start next to it.
TEST(SelfHit, RaysLeaveTrianglesAndTheirNeighbours) { EXPECT_EQ(share_of_parallelograms(1, 0.05, 1), 0); }

// What makes the test above one that can fail: with a sixteenth of the distance some rays are caught.
TEST(SelfHit, AreCaughtWhereTheyStartTooNear) { EXPECT_GT(share_of_parallelograms(1, 0.05, 1 / 16.f), 1e-4); }

// Where one edge lies nearly along the other the tracer's error grows with the square of the length over the height. 4
// rays of 100,000 are caught where triangles may be a hundred times longer than high, 2 of 10,000 where a thousand
// times.
TEST(SelfHit, RaysLeaveSplinters) {
    EXPECT_LT(share_of_parallelograms(2, 1e-2, 1), 1e-4);
    EXPECT_LT(share_of_parallelograms(2, 1e-3, 1), 5e-4);
}

TEST(SelfHit, RaysLeaveSpheres) {
    Chance chance(3);
    for (int i = 0; i < 2000; ++i)
        EXPECT_EQ(share_that_hits(chance, ball(random_place(chance)), rays_a_scene, 1), 0);
}

// Where a camera or a lamp may be. The point is ahead, not behind.
TEST(SelfHit, RaysFromTheVeryCenterMeetTheSphere) {
    for (const vec3 place : {v3(0, 0, 0), v3(5, -2, 0.1f), v3(-1e3f, 0, 0)}) {
        Surfaces surfaces(ball(place));
        Chance chance(5);
        Batch batch;
        for (std::size_t ray = 0; ray < rays_a_scene; ++ray) {
            const vec3 direction = chance.direction();
            batch.add(place, direction, ray_pending);
            const primitive_hit hit = primitive_hit_of(surfaces.tables.triangles.data(), surfaces.tables.spheres.data(),
                                                       unit, 0, 0, place, direction);
            EXPECT_NEAR(v3_dot(v3_sub(hit.position, place), direction), 1, 1e-3);
        }
        RayColumns columns = batch.columns<RayColumns>();
        columns.primitive = batch.state.data();
        surfaces.tracer.trace(columns, rays_a_scene, ShadowColumns{}, 0);
        EXPECT_EQ(std::count(batch.state.begin(), batch.state.end(), 0u), std::ptrdiff_t(rays_a_scene));
    }
}

// One may be near the origin and the other up to 1e4 away: the way's own length decides how well its end is known.
TEST(SelfHit, ConnectionsMeetNeitherEnd) {
    Chance chance(4);
    for (int i = 0; i < 2000; ++i) {
        const vec3 place = random_place(chance);
        Scene scene = parallelogram(chance, place, 0.05);
        const vec3 elsewhere = v3_mad(place, float(chance.magnitude(0.6, 4)), chance.direction());
        const Scene other = parallelogram(chance, elsewhere, 0.05);
        scene.meshes.push_back(other.meshes[0]);
        scene.shapes.emplace_back().geometry = 1;
        Surfaces surfaces(scene);
        Batch batch;
        for (std::size_t ray = 0; ray < rays_a_scene; ++ray) {
            const std::uint32_t from = ray % 2, to = 2 + ray / 2 % 2;
            const primitive_hit a = surfaces.point(chance, from), b = surfaces.point(chance, to);
            const vec3 way = v3_sub(b.position, a.position);
            const vec3 end = connection_end(b.position, b.normal, surfaces.offset(to, b), way);
            const vec3 start = ray_origin(a.position, a.normal, surfaces.offset(from, a), way);
            batch.add(start, v3_sub(end, start), 1);
        }
        ShadowColumns columns = batch.columns<ShadowColumns>();
        columns.open = batch.state.data();
        surfaces.tracer.trace(RayColumns{}, 0, columns, rays_a_scene);
        EXPECT_EQ(std::count(batch.state.begin(), batch.state.end(), 0u), 0) << "scene " << i;
    }
}

// Lamps of all sizes at the origin and elsewhere, from places up to 1e8 of their radii away, as light sampling finds
// their points: none is lost. Where the lamp's own coordinates are small, the way alone says how well its surface is
// known.
TEST(SelfHit, ConnectionsEndBeforeTheLampThatIsASphere) {
    Chance chance(6);
    for (int i = 0; i < 2000; ++i) {
        const vec3 center = random_place(chance);
        Scene scene = ball(center);
        const double from_origin = std::sqrt(v3_length_squared(center));
        const double radius = chance.magnitude(-4, 1) * std::max(from_origin, 1.0), area = 4 * M_PI * radius * radius;
        scene.spheres[0].radius = float(radius);
        Surfaces surfaces(scene);
        const float of_sphere =
            primitive_offset(surfaces.tables.triangles.data(), surfaces.tables.spheres.data(), unit, 0, 0);
        Batch batch;
        for (std::size_t ray = 0; ray < rays_a_scene; ++ray) {
            const vec3 place = v3_mad(center, float(radius * chance.magnitude(0.1, 8)), chance.direction());
            const light_choice s = light_from_sphere(rgb_gray(1), center, float(radius), 1, float(1 / area), place,
                                                     float(chance.uniform()), float(chance.uniform()));
            EXPECT_GT(s.pdf, 0);
            const float offset = offset_at(v3_add(place, s.connection), s.normal, of_sphere);
            batch.add(place, connection_before(s.connection, s.normal, offset, s.connection), 1);
        }
        ShadowColumns columns = batch.columns<ShadowColumns>();
        columns.open = batch.state.data();
        surfaces.tracer.trace(RayColumns{}, 0, columns, rays_a_scene);
        EXPECT_EQ(std::count(batch.state.begin(), batch.state.end(), 0u), 0)
            << "radius " << radius << " at " << from_origin;
    }
}

} // namespace
} // namespace gradus::testing
